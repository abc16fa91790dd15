#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "apps/check/excesses.hpp"
#include "apps/cli/option_rows.hpp"
#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/fit/curve.hpp"
#include "apps/fit/executed.hpp"
#include "apps/fit/options.hpp"
#include "apps/limits/file.hpp"
#include "apps/limits/options.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/streams/report.hpp"
#include "apps/tables/kinds.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

struct CheckOptions {
  std::string file;
  TableOptions table;
  const Method* method = nullptr;
  CurveOptions curve;
  LimitOptions limits;
  bool waypoints = false;    ///< of a recording: fit them
  bool is_executed = false;  ///< take the executed curve of a recording
  bool json = false;
};

/// Whether the curve ends at rest without `--end`. Some curves have no full stop.
bool rests_by_default(const CheckOptions& options) {
  const auto& start = options.curve.start;
  const bool is_periodic = start && start->kind == ConditionKind::periodic;
  return !options.curve.end && !is_periodic && options.method->name != "normalized";
}

/// The result of a check.
struct CheckReport {
  std::string file;
  std::vector<std::string> names;
  std::string method;
  Time begin{};
  Time end{};
  ipc::EndKind rest = ipc::EndKind::none;  ///< how a fitted curve ends at rest
  Time late{};                             ///< see FittedCurve
  CurveCheck check;
  LimitGaps gaps;
  std::vector<std::string> notes;
};

/// The given limits for the dimensions of a file.
MotionLimits limits_of(const LimitOptions& options, const LimitFile& file, const std::string& of,
                       const std::vector<std::string>& names, const std::vector<Dimension>& kinds) {
  MotionLimits limits =
      core::overridden(core::matched(file.joints, names), spread(options.given, names.size()));
  require_limits(limits, kinds);
  if (limits.empty()) {
    throw InputError(fmt::format("{}: none of the limits is for one of its dimensions", of));
  }
  return limits;
}

/// Checks the executed curve of a recording, against the limits of its stream unless others are
/// given.
CheckReport check_executed(const CheckOptions& options) {
  const Executed executed = read_executed_curve(options.file, options.table);
  LimitFile file;
  if (!options.limits.file.empty()) file = read_limit_file(options.limits.file);
  MotionLimits limits = executed.limits();
  if (options.limits.any()) {
    limits =
        limits_of(options.limits, file, executed.stream.file, executed.names(), executed.kinds());
  }
  if (limits.empty()) {
    throw InputError(
        fmt::format("{}: stream '{}' has no limits: give them with --limits, "
                    "--max-velocity, --max-acceleration, --max-jerk or --bounds",
                    executed.stream.file, executed.stream.curve.options().stream));
  }
  return {.file = executed.stream.file,
          .names = executed.names(),
          .method = "the executed curve",
          .begin = executed.parts.front().breaks().front(),
          .end = executed.parts.back().breaks().back(),
          .check = check_curve(executed.parts, limits, DimensionKinds(executed.kinds())),
          .gaps = limit_gaps(limits, file.joints, executed.names(), executed.kinds()),
          .notes = file.notes};
}

CheckReport checked(const CheckOptions& options) {
  if (options.is_executed) return check_executed(options);
  WaypointTable table = read_waypoints(options.file, options.table);
  require_spline_input(table);
  continue_waypoints(table);
  LimitFile file;
  if (!options.limits.file.empty()) file = read_limit_file(options.limits.file);
  std::vector<Dimension> kinds = table.kinds;
  kinds.resize(table.dimensions());
  const MotionLimits limits = limits_of(options.limits, file, table.file, table.names, kinds);
  CurveOptions how = options.curve;
  how.rest.limits = limits;
  how.rest.kinds = DimensionKinds(kinds);
  const FittedCurve fitted = fit_table(table, *options.method, how);
  return {.file = table.file,
          .names = table.names,
          .method = std::string(options.method->name),
          .begin = fitted.curve.breaks().front(),
          .end = fitted.curve.breaks().back(),
          .rest = fitted.end,
          .late = fitted.late,
          .check = check_curve({&fitted.curve, 1}, limits, DimensionKinds(kinds)),
          .gaps = limit_gaps(limits, file.joints, table.names, kinds),
          .notes = file.notes};
}

ordered_json excess_json(const std::optional<TimedExcess>& found, const CheckReport& report) {
  if (!found) return nullptr;
  const Excess& excess = found->excess;
  return {{"kind", to_string(excess.kind)},
          {"dimension", excess.dimension},
          {"name", report.names[excess.dimension]},
          {"time_ns", found->time.count()},
          {"value", excess.value},
          {"limit", excess.limit},
          {"ratio", excess.ratio}};
}

/// How the curve ends; null if it ends with a condition.
ordered_json end_json(const CheckReport& report) {
  if (report.rest == ipc::EndKind::none) return nullptr;
  return {{"kind", to_string(report.rest)}, {"lateness_ns", report.late.count()}};
}

ordered_json to_json(const CheckReport& report) {
  const CurveCheck& check = report.check;
  ordered_json worst = ordered_json::object();
  for (std::size_t kind = 0; kind < check.worst.size(); ++kind) {
    worst[std::string(to_string(static_cast<LimitKind>(kind)))] =
        excess_json(check.worst[kind], report);
  }
  return {{"file", report.file},
          {"method", report.method},
          {"begin_ns", report.begin.count()},
          {"end_ns", report.end.count()},
          {"keeps_limits", check.keeps_limits()},
          {"end", end_json(report)},
          {"segments", check.segments},
          {"segments_beyond", check.segments_beyond},
          {"first_violation", excess_json(check.first_violation, report)},
          {"worst", worst},
          {"slowing", check.slowing},
          {"slowing_suffices", check.slowing > 0 && check.keeps_bounds},
          {"names_without_dimension", report.gaps.unmatched},
          {"dimensions_without_limit", report.gaps.without},
          {"notes", report.notes}};
}

std::string text_of(const TimedExcess& found, const CheckReport& report) {
  const Excess& excess = found.excess;
  return fmt::format("{:.6g} of {:.6g} (ratio {:.6g}), '{}' at {:.9f} s", excess.value,
                     excess.limit, excess.ratio, report.names[excess.dimension],
                     to_seconds(found.time));
}

std::string advice_of(const CurveCheck& check) {
  std::string text;
  if (check.slowing == 0) text += "no lower speed keeps the limits\n";
  if (check.slowing > 0 && check.slowing < 1) {
    // Rounded down, so that the printed factor is slow enough.
    text +=
        fmt::format("{:.4f} times the speed keeps the limits of velocity, acceleration and jerk\n",
                    std::floor(check.slowing * 1e4) / 1e4);
  }
  if (!check.keeps_bounds) text += "slowing cannot keep the bounds of the position\n";
  return text;
}

std::string to_text(const CheckReport& report) {
  const CurveCheck& check = report.check;
  std::string text =
      fmt::format("{}: {} segments of {} from {:.9f} s to {:.9f} s\n", report.file, check.segments,
                  report.method, to_seconds(report.begin), to_seconds(report.end));
  for (std::size_t kind = 0; kind < check.worst.size(); ++kind) {
    const auto& worst = check.worst[kind];
    text += fmt::format("{:<16}  {}\n", to_string(static_cast<LimitKind>(kind)),
                        worst ? text_of(*worst, report) : "no limit");
  }
  const std::string end = end_in_words(report.rest, report.late);
  if (!end.empty()) text += fmt::format("{:<16}  {}\n", "end", end);
  if (check.keeps_limits()) return text + "all limits are kept\n";
  const TimedExcess& first = *check.first_violation;
  text += fmt::format("first violation   {} {}\n", to_string(first.excess.kind),
                      text_of(first, report));
  text +=
      fmt::format("{} of {} segments exceed their limits\n", check.segments_beyond, check.segments);
  return text + advice_of(check);
}

int run_check(const CheckOptions& options) {
  const CheckReport report = checked(options);
  for (const std::string& note : report.notes) say(note);
  for (const std::string& line : to_lines(report.gaps)) say(line);
  print_report(options.json ? pretty(to_json(report)) : to_text(report));
  return report.check.keeps_limits() ? kOk : kFellShort;
}

void add_check(Command& verb, Action& action) {
  auto options = std::make_shared<CheckOptions>();
  verb.option("FILE", options->file, "Waypoint file, CSV or TUM text; - for standard input")
      .required();
  add_limit_options(verb, options->limits);
  verb.option(
          "--method", [options](const std::string& text) { options->method = &method_named(text); },
          fmt::format("Interpolant: {} (default c2)", method_names(false)))
      .type("METHOD");
  add_curve(verb, options->curve,
            "Boundary condition at the last waypoint, or rest: at rest as a live stream ends, "
            "within the limits (default: rest; with --start periodic and for normalized the "
            "method's own)");
  add_curve_option<&SolverOptions::stop_time>(verb, options->curve.rest.stop_length, "SECONDS");
  add_table_options(verb, options->table);
  add_waypoints(verb, options->waypoints);
  verb.flag("--json", options->json, "Print JSON");
  verb.callback([&action, options, verb] {
    options->is_executed =
        uses_executed(verb, options->file, options->waypoints,
                      {"--limits", "--max-velocity", "--max-acceleration", "--max-jerk", "--bounds",
                       "--topic", "--quiet", "--json"});
    if (options->method == nullptr) options->method = &c2();
    require_consistent(options->curve, std::array{options->method});
    if (rests_by_default(*options)) options->curve.end = AtRest{};
    if (!options->limits.any() && !options->is_executed) {
      throw UsageError("check",
                       "needs limits: --limits, --max-velocity, --max-acceleration, "
                       "--max-jerk or --bounds");
    }
    action = [options] { return run_check(*options); };
  });
}

const Verb check_verb(
    "check", 60, "Compare the spline through a file with limits; exit code 3 if it exceeds one",
    add_check);

}  // namespace

}  // namespace splinecast::apps
