#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>

#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/files/numbers.hpp"
#include "apps/files/unit_of_name.hpp"
#include "apps/fit/curve.hpp"
#include "apps/fit/executed.hpp"
#include "apps/fit/options.hpp"
#include "apps/fit/pieces.hpp"
#include "apps/fit/report_page.hpp"
#include "apps/output/emit.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/kinds.hpp"
#include "splinecast/fit.hpp"

namespace splinecast::apps {
namespace {

struct FitOptions {
  std::string file;
  TableOptions table;
  std::vector<const Method*> methods;
  CurveOptions curve;
  std::string at;
  std::optional<Time> dt;
  Emit emit = Emit::samples;
  std::string output;
  std::string report;
  std::vector<std::string> units;  ///< of positions in the report; the last one repeats
  bool waypoints = false;          ///< of a recording: fit them
  bool is_executed = false;        ///< take the executed curve of a recording
};

void require_inside(const std::vector<Time>& times, std::span<const PiecewisePolynomial> parts,
                    const std::string& file) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (std::ranges::any_of(parts, [&](const auto& part) { return covers(part, times[i]); }))
      continue;
    throw InputError(fmt::format("{}: row {}: time {} ns is outside the data, {} ns to {} ns{}",
                                 file, i + 1, times[i].count(),
                                 parts.front().breaks().front().count(),
                                 parts.back().breaks().back().count(),
                                 parts.size() > 1 ? ", or where segments are missing" : ""));
  }
}

/// Writes the report, with the units of `--unit` if there are any.
void write_report_to_file(Report report, const FitOptions& options) {
  for (std::size_t d = 0; d < report.units.size() && !options.units.empty(); ++d) {
    report.units[d] = options.units[std::min(d, options.units.size() - 1)];
  }
  Output output(options.report);
  write_report(report, output);
  output.close();
}

void write_report_of(const WaypointTable& table, std::vector<ReportCurve> curves,
                     const FitOptions& options) {
  Report report{.title = table.file,
                .names = {},
                .units = {},
                .waypoints = table.waypoints(),
                .kinds = table.kinds,
                .curves = std::move(curves)};
  for (std::size_t d = 0; d < table.dimensions(); ++d) {
    auto [name, unit] = name_and_unit(table.names[d]);
    report.names.push_back(std::move(name));
    report.units.push_back(std::move(unit));
  }
  write_report_to_file(std::move(report), options);
}

/// Throws InputError if --dt makes more than 1e9 samples.
void require_samples(std::span<const PiecewisePolynomial> parts, Time dt) {
  constexpr std::int64_t kMost = 1'000'000'000;
  std::int64_t samples = 0;
  for (const PiecewisePolynomial& part : parts) {
    samples += (part.breaks().back() - part.breaks().front()) / dt;
  }
  if (samples <= kMost) return;
  throw InputError(
      fmt::format("--dt {} makes {} samples; the maximum is {}", to_seconds(dt), samples, kMost));
}

/// Whether a report is the only output.
bool only_reports(const FitOptions& options) {
  return !options.report.empty() && options.emit == Emit::samples && options.at.empty() &&
         !options.dt;
}

/// The output files; an empty name is standard output.
std::vector<std::string> outputs_of(const FitOptions& options) {
  std::vector<std::string> outputs;
  if (!options.report.empty()) outputs.push_back(options.report);
  if (!only_reports(options)) outputs.push_back(options.output);
  return outputs;
}

std::vector<Time> times_of(const FitOptions& options) {
  return options.at.empty() ? std::vector<Time>{}
                            : read_times(options.at, {.time_unit = options.table.time_unit});
}

/// The only part of an executed curve, for an output that has one curve.
const PiecewisePolynomial& only_part(const Executed& executed) {
  if (executed.parts.size() == 1) return executed.parts.front();
  throw InputError(
      fmt::format("{}: the curve has {} parts, because segments are missing between them; this "
                  "output has one curve: --dt and --report take them all",
                  executed.stream.file, executed.parts.size()));
}

int run_executed(const FitOptions& options) {
  const Executed executed = read_executed_curve(options.file, options.table);
  const auto at = times_of(options);
  require_inside(at, executed.parts, options.at);
  if (options.dt) require_samples(executed.parts, *options.dt);
  if (!options.report.empty()) {
    write_report_to_file(report_of(executed, options.file), options);
  }
  if (only_reports(options)) return kOk;
  Output output(options.output);
  if (options.emit == Emit::samples) {
    emit_samples(executed.parts, DimensionKinds(executed.kinds()), at, options.dt, output);
  } else {
    emit_json(only_part(executed), executed.columns(), options.emit, output);
  }
  output.close();
  return kOk;
}

int run_fit(const FitOptions& options) {
  require_separate(outputs_of(options), std::array{options.file, options.at});
  if (options.is_executed) return run_executed(options);
  WaypointTable table = read_waypoints(options.file, options.table);
  require_spline_input(table);
  continue_waypoints(table);
  const Gaps gaps = find_gaps(table, options.curve.gap).gaps;
  if (gaps.count > 0 && !options.table.quiet) {
    say(fmt::format("{}: {}", table.file,
                    in_words(gaps, options.curve.gap.policy, table.row_name())));
  }
  std::vector<ReportCurve> curves;
  for (const Method* method : options.methods) {
    curves.push_back({.name = std::string(method->name),
                      .curve = fit_table(table, *method, options.curve).curve});
  }
  const PiecewisePolynomial curve = curves.front().curve;
  const auto at = times_of(options);
  require_inside(at, {&curve, 1}, options.at);
  if (options.dt) require_samples({&curve, 1}, *options.dt);
  if (!options.report.empty()) write_report_of(table, std::move(curves), options);
  if (only_reports(options)) return kOk;
  Output output(options.output);
  if (options.emit == Emit::samples) {
    emit_samples({&curve, 1}, DimensionKinds(table.kinds), at, options.dt, output);
  } else {
    emit_json(curve, table.names, options.emit, output);
  }
  output.close();
  return kOk;
}

void require_consistent(const FitOptions& options) {
  const auto refuse = [](const std::string& name, const std::string& why) {
    throw UsageError(name, why);
  };
  require_consistent(options.curve, options.methods);
  if (options.methods.size() > 1 && !only_reports(options)) {
    refuse("--method", "several methods need --report as the only output");
  }
  if (!options.units.empty() && options.report.empty()) refuse("--unit", "goes with --report only");
  if (!options.output.empty() && only_reports(options)) {
    refuse("-o", "needs --at, --dt or --emit in addition to --report");
  }
  if (options.emit == Emit::samples) {
    if (options.at.empty() && !options.dt && options.report.empty()) {
      refuse("fit", "needs --at or --dt to write samples, or --report");
    }
  } else if (!options.at.empty() || options.dt) {
    refuse("--at, --dt", "go with --emit samples only");
  }
}

void add_interpolants(Command& verb, std::vector<const Method*>& methods) {
  verb.option(
          "--method",
          [&methods](const std::vector<std::string>& names) {
            for (const std::string& name : names) methods.push_back(&method_named(name));
          },
          fmt::format("Interpolant: {} (default c2); with --report, a list separated by commas",
                      method_names(false)))
      .separated_by_commas()
      .type("METHOD");
}

void add_emit(Command& verb, Emit& value) {
  verb.option(
          "--emit",
          [&value](const std::string& text) {
            const auto emit = parse_emit(text);
            if (!emit) {
              throw UsageError(
                  "--emit", fmt::format("'{}' is not one of samples, pp, bezier, bspline", text));
            }
            value = *emit;
          },
          "Output: samples (CSV, default), or as JSON: pp (piecewise polynomial), bezier (control "
          "points), bspline")
      .type("samples|pp|bezier|bspline");
}

void add_fit(Command& verb, Action& action) {
  auto options = std::make_shared<FitOptions>();
  verb.option("FILE", options->file, "Waypoint file, CSV or TUM text; - for standard input")
      .required();
  add_interpolants(verb, options->methods);
  add_curve(verb, options->curve,
            "Boundary condition at the last waypoint, or with --online rest: at rest as a live "
            "stream ends (default: natural for c2, with --online halt; else the method's own)");
  const Argument at =
      verb.option("--at", options->at, "File with a time column: the times to sample").type("FILE");
  add_seconds(verb, "--dt", options->dt,
              "Interval between samples in s, above 0; starts at the first waypoint", kPositiveTime)
      .excludes(at);
  add_emit(verb, options->emit);
  verb.option("-o,--output", options->output, "File to write (default: standard output)")
      .type("OUT");
  verb.option("--report", options->report, "HTML page of charts to write").type("OUT");
  verb.option("--unit", options->units,
              "Unit of the positions in the report, or one per column (default: the text in "
              "brackets in the column's name)")
      .separated_by_commas()
      .type("UNIT");
  add_table_options(verb, options->table);
  add_waypoints(verb, options->waypoints);
  verb.callback([&action, options, verb] {
    options->is_executed = uses_executed(verb, options->file, options->waypoints,
                                         {"--at", "--dt", "--emit", "--output", "--report",
                                          "--unit", "--topic", "--quiet", "--time-unit"});
    if (options->methods.empty()) options->methods.push_back(&c2());
    if (!options->curve.online) take_former_rest(options->curve.end);
    require_consistent(*options);
    action = [options] { return run_fit(*options); };
  });
}

const Verb fit_verb("fit", 50, "Fit a spline to a file, without shared memory", add_fit);

}  // namespace

}  // namespace splinecast::apps
