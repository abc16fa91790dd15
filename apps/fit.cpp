#include <fmt/format.h>

#include <cstdlib>
#include <memory>

#include "splinecast/core/c2_spline.hpp"
#include "splinecast/core/sliding_window.hpp"
#include "support/emit.hpp"
#include "support/exit_codes.hpp"
#include "support/options.hpp"
#include "support/output.hpp"
#include "support/report_page.hpp"

namespace splinecast::apps {
namespace {

struct FitOptions {
  std::string file;
  TableOptions table;
  std::optional<core::Condition> start;
  std::optional<core::Condition> end;
  bool online = false;
  std::optional<std::size_t> settle;
  std::optional<core::Tail> tail;
  std::string at;
  std::optional<core::Time> dt;
  Emit emit = Emit::samples;
  std::string output;
  std::string report;
};

/// Feeds the waypoints through the sliding window, as the solver does, and keeps each segment as it
/// settles.
core::PiecewisePolynomial fit_online(const WaypointTable& table, const FitOptions& options) {
  core::WindowOptions how;
  how.settle = options.settle.value_or(how.settle);
  how.tail = options.tail.value_or(how.tail);
  how.start = options.start.value_or(core::Condition{});
  core::SlidingWindow window(table.dimensions(), how);
  core::PiecewisePolynomial curve(table.dimensions());
  core::Segment segment(table.dimensions());
  const auto take_settled = [&] {
    while (curve.segments() < window.settled_segments()) {
      window.segment(curve.segments(), segment);
      curve.append(segment);
    }
  };
  for (std::size_t i = 0; i < table.size(); ++i) {
    window.append(table.waypoint(i));
    take_settled();
  }
  const core::Condition end =
      options.end.value_or(core::Condition{.kind = core::ConditionKind::halt, .value = {}});
  core::require_values(end, table.dimensions());
  window.finish(end);
  take_settled();
  return curve;
}

core::PiecewisePolynomial fit(const WaypointTable& table, const FitOptions& options) {
  if (options.online) return fit_online(table, options);
  return core::c2_spline(table.times, table.positions, table.dimensions(),
                         options.start.value_or(core::Condition{}),
                         options.end.value_or(core::Condition{}));
}

void require_inside(const std::vector<core::Time>& times, const core::PiecewisePolynomial& curve,
                    const std::string& file) {
  const core::Time first = curve.breaks().front();
  const core::Time last = curve.breaks().back();
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] >= first && times[i] <= last) continue;
    throw InputError(
        fmt::format("{}: row {}: time {} ns lies outside the data, which go from {} ns to {} ns",
                    file, i + 1, times[i].count(), first.count(), last.count()));
  }
}

void write_report_of(const WaypointTable& table, const core::PiecewisePolynomial& curve,
                     const FitOptions& options) {
  const core::Waypoints waypoints{
      .dimensions = table.dimensions(), .times = table.times, .positions = table.positions};
  Output output(options.report);
  write_report({.title = table.file,
                .names = table.names,
                .units = std::vector<std::string>(table.dimensions()),
                .waypoints = waypoints,
                .curves = {{.name = "c2", .curve = curve}}},
               output);
  output.close();
}

/// Whether all that is asked for is a report.
bool only_reports(const FitOptions& options) {
  return !options.report.empty() && options.emit == Emit::samples && options.at.empty() &&
         !options.dt;
}

int run_fit(const FitOptions& options) {
  const WaypointTable table = read_waypoints(options.file, options.table);
  require_spline_input(table);
  const auto curve = fit(table, options);
  const auto at = options.at.empty() ? std::vector<core::Time>{}
                                     : read_times(options.at, options.table.time_unit);
  require_inside(at, curve, options.at);
  if (!options.report.empty()) write_report_of(table, curve, options);
  if (only_reports(options)) return kOk;
  Output output(options.output);  // after all input was read: it may be the same file
  if (options.emit == Emit::samples) {
    emit_samples(curve, at, options.dt, output);
  } else {
    emit_json(curve, options.emit, output);
  }
  output.close();
  return kOk;
}

void require_consistent(const FitOptions& options) {
  const auto refuse = [](const std::string& name, const std::string& why) {
    throw CLI::ValidationError(name, why);
  };
  if (!options.online && (options.settle || options.tail)) {
    refuse("--settle, --tail", "go with --online only");
  }
  if (options.emit == Emit::samples) {
    if (options.at.empty() && !options.dt && options.report.empty()) {
      refuse("fit", "needs --at or --dt to write samples, or --report");
    }
  } else if (!options.at.empty() || options.dt) {
    refuse("--at, --dt", "go with --emit samples only");
  }
  if (options.dt && *options.dt <= core::Time::zero()) {
    refuse("--dt", "must be at least a nanosecond");
  }
}

void add_emit(CLI::App& verb, Emit& value) {
  verb.add_option_function<std::string>(
          "--emit",
          [&value](const std::string& text) {
            const auto emit = parse_emit(text);
            if (!emit) {
              throw CLI::ValidationError(
                  "--emit", fmt::format("'{}' is none of samples, pp, bezier, bspline", text));
            }
            value = *emit;
          },
          "What to write: samples (CSV, default); as JSON pp (piecewise polynomial), bezier "
          "(control points), bspline")
      ->type_name("WHAT");
}

}  // namespace

void add_fit(CLI::App& program, Action& action) {
  auto options = std::make_shared<FitOptions>();
  auto* verb = program.add_subcommand("fit", "Fit a spline to a file, without shared memory");
  verb->add_option("FILE", options->file, "Waypoint file, CSV or TUM text; - for standard input")
      ->required();

  add_condition(*verb, "--start", options->start,
                "Condition at the first waypoint (default natural)");
  add_condition(*verb, "--end", options->end,
                "Condition at the last waypoint (default natural; halt with --online)");
  verb->add_flag("--online", options->online, "As the solver would: through the sliding window");
  add_settle(*verb, options->settle);
  add_tail(*verb, options->tail);
  auto* at = verb->add_option("--at", options->at, "File with a time column: where to sample")
                 ->type_name("FILE");
  add_seconds(*verb, "--dt", options->dt, "Sample this often, from the first waypoint on");
  verb->get_option("--dt")->excludes(at);
  add_emit(*verb, options->emit);
  verb->add_option("-o,--output", options->output, "File to write (default: standard output)")
      ->type_name("OUT");
  verb->add_option("--report", options->report, "Page of charts to write, HTML")->type_name("OUT");
  add_table_options(*verb, options->table);
  verb->callback([&action, options] {
    require_consistent(*options);
    action = [options] { return run_fit(*options); };
  });
}

}  // namespace splinecast::apps
