#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "apps/advise/report.hpp"
#include "apps/cli/option_rows.hpp"
#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/recordings/advice.hpp"
#include "apps/recordings/recording.hpp"
#include "apps/streams/report.hpp"
#include "apps/streams/rows.hpp"
#include "apps/tables/kinds.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/roles/inspect.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::apps {
namespace {

struct AdviseOptions {
  std::string source;
  TableOptions table;
  std::optional<std::size_t> settle;
  std::optional<Time> settle_ahead;
  bool json = false;
  Trust trust;
};

/// The rows to analyze, and their source.
struct Rows {
  WaypointTable table;
  AdviceSource source;
};

Rows rows_of_file(const AdviseOptions& options) {
  constexpr ipc::IntervalRange kAnyInterval{.least = Time(1), .most = Time::max()};
  Rows rows{.table = read_waypoints(options.source, options.table), .source = {}};
  rows.source.name = rows.table.file;
  const LateRows late =
      prepare(rows.table, {.intervals = kAnyInterval, .late = LatePolicy::pass}, nullptr);
  rows.source.duplicates = late.duplicate;
  rows.source.out_of_order = late.out_of_order;
  return rows;
}

/// Options and counters on the board of a stream; nullopt if no solver has attached to it.
std::optional<AdviceSource::Solved> solved_of(const ipc::StreamInfo& info) {
  if (!info.spline || info.spline->stream_id != info.waypoints->stream_id) return std::nullopt;
  const ipc::LiveOptions live = ipc::live_options(*info.spline).value_or(ipc::LiveOptions{});
  AdviceSource::Solved solved{
      .how = {.settle = info.spline->settle, .settle_ahead = live.settle_ahead},
      .stop_length = ipc::window_options(*info.spline).stop_length,
      .deadline_misses = info.summary.deadline_misses,
      .late_commits = info.summary.late_commits};
  if (info.summary.low_water < Time::max()) solved.low_water = info.summary.low_water;
  return solved;
}

Rows rows_of_stream(const AdviseOptions& options) {
  const ipc::StreamInfo info = ipc::inspect(options.source, options.trust);
  if (!info.waypoints) {
    throw InputError(fmt::format("stream '{}' has no producer yet", options.source));
  }
  Rows rows{.table = read_stream_rows(options.source, options.trust), .source = {}};
  const auto refused = [&](AppendStatus status) {
    return info.refused_by_producer[static_cast<std::size_t>(status)];
  };
  rows.source.name = rows.table.file;
  rows.source.duplicates = refused(AppendStatus::duplicate);
  rows.source.out_of_order = refused(AppendStatus::out_of_order);
  rows.source.solved = solved_of(info);
  return rows;
}

bool is_stream(const std::string& name) {
  const std::vector<std::string> streams = stream_names();
  return std::ranges::find(streams, name) != streams.end();
}

Rows rows_of(const AdviseOptions& options) {
  if (is_stream(options.source)) return rows_of_stream(options);
  if (options.source != "-" && !std::filesystem::exists(options.source)) {
    throw InputError(fmt::format("there is neither a file nor a stream '{}'", options.source));
  }
  return rows_of_file(options);
}

/// The freeze-ahead to recommend; doubles the stream's own if revisions were late.
Time freeze_ahead_of(const AdviseOptions& options, const AdviceSource& source) {
  if (options.settle_ahead) return *options.settle_ahead;
  if (!source.solved) return SolvedHow{}.settle_ahead;
  const Time own = source.solved->how.settle_ahead;
  return source.solved->was_late() ? saturated_product(own, 2) : own;
}

int run_advise(const AdviseOptions& options) {
  Rows rows = rows_of(options);
  AdviceSource& source = rows.source;
  source.rows = rows.table.size();
  source.columns = rows.table.names;
  continue_waypoints(rows.table);
  std::optional<std::size_t> settle = options.settle;
  if (!settle && source.solved) settle = source.solved->how.settle;
  const Advice advice =
      advise(rows.table, freeze_ahead_of(options, source), settle, source.solved.has_value());
  source.length = rows.table.times.back() - rows.table.times.front();
  print_report(options.json ? pretty(to_json(advice, source)) : in_words(advice, source));
  return kOk;
}

void add_advise(Command& verb, Action& action) {
  auto options = std::make_shared<AdviseOptions>();
  verb.option("FILE|STREAM", options->source,
              "Waypoint file, CSV or TUM text, - for standard input; or a stream, to analyze the "
              "waypoints in its ring (write ./NAME for a file of that name)")
      .required();
  add_curve_option<&SolverOptions::settle>(verb, options->settle, "K")
      .help(
          "Settle lag of the solver in knots, 0 to 64 (default: the stream's own; for a file 8, or "
          "less if 8 needs a lead of more than 1 s)");
  verb.option(
          "--freeze-ahead",
          [options](const std::string& text) {
            options->settle_ahead = time_within("--freeze-ahead", text, TimeUnit::milliseconds);
          },
          "Time ahead of now, in ms, up to which the curve is settled: above 0 (default: 5, or the "
          "stream's own)")
      .type("MS");
  verb.flag("--json", options->json, "Print JSON");
  add_table_options(verb, options->table);
  add_trust(verb, options->trust);
  verb.callback([&action, options] { action = [options] { return run_advise(*options); }; });
}

const Verb advise_verb(
    "advise", 80, "Recommend lead, settle lag, freeze-ahead, stop time and limits, with reasons",
    add_advise);

}  // namespace

}  // namespace splinecast::apps
