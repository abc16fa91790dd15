#include "replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "splinecast/ipc/producer.hpp"
#include "splinecast/ipc/stream_files.hpp"
#include "support/exit_codes.hpp"
#include "support/options.hpp"
#include "support/output.hpp"
#include "support/signals.hpp"

namespace splinecast::apps {
namespace {

constexpr core::Time kSlice = std::chrono::milliseconds(50);

/// Keeps the rows of a table from `from` on, for `duration`; both count from its first time.
void select(WaypointTable& table, const ReplayOptions& options) {
  const core::Time first = table.times.front() + options.from.value_or(core::Time::zero());
  const auto is_in = [&](core::Time t) {
    return t >= first && (!options.duration || t - first <= *options.duration);
  };
  WaypointTable kept = table.without_rows();
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (is_in(table.times[i])) kept.append_row(table, i);
  }
  if (kept.size() == 0) {
    throw InputError(fmt::format("{}: no waypoint lies within --from and --duration", table.file));
  }
  table = std::move(kept);
}

/// Scales times about the first one by 1/rate, velocities by rate, accelerations by rate².
void scale(WaypointTable& table, double rate) {
  if (rate == 1.0) return;
  const core::Time first = table.times.front();
  for (core::Time& t : table.times) {
    t = first + core::Time(std::llround(static_cast<double>((t - first).count()) / rate));
  }
  for (double& v : table.velocities) v *= rate;
  for (double& a : table.accelerations) a *= rate * rate;
}

core::Time median_interval(const WaypointTable& table) {
  std::vector<core::Time> intervals;
  for (std::size_t i = 1; i < table.size(); ++i) {
    intervals.push_back(table.times[i] - table.times[i - 1]);
  }
  if (intervals.empty()) return std::chrono::milliseconds(10);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::ranges::nth_element(intervals, middle);
  return *middle;
}

std::string value_in_row(const WaypointTable& table, std::size_t i) {
  const core::Waypoint row = table.waypoint(i);
  const char* const letters[] = {"", "v of ", "a of "};
  const std::span<const double> parts[] = {row.position, row.velocity, row.acceleration};
  for (std::size_t p = 0; p < 3; ++p) {
    for (std::size_t d = 0; d < parts[p].size(); ++d) {
      if (std::isfinite(parts[p][d])) continue;
      return fmt::format("column '{}{}': {}", letters[p], table.names[d], parts[p][d]);
    }
  }
  return {};
}

/// Why a row was not accepted, with its line and the offending value.
std::string refusal_message(const WaypointTable& table, std::size_t i, ipc::AppendStatus status,
                            core::Time interval) {
  const std::string row =
      fmt::format("{}: waypoint refused: {}", table.where(i), ipc::to_string(status));
  switch (status) {
    case ipc::AppendStatus::not_finite:
      return fmt::format("{}: {}", row, value_in_row(table, i));
    case ipc::AppendStatus::not_increasing:
    case ipc::AppendStatus::interval_out_of_range:
      return fmt::format("{}: time {} ns, {} ns after the waypoint before", row,
                         table.times[i].count(), interval.count());
    default:
      return row;
  }
}

/// What the ring would say to the rows of a table, said before anything is sent.
class RowCheck {
 public:
  RowCheck(const WaypointTable& table, const ReplayOptions& options)
      : table_(&table), limits_(options.limits) {}

  /// Judges row i against the last row that passed.
  ipc::AppendStatus judge(std::size_t i) {
    const core::Waypoint row = table_->waypoint(i);
    if (!ipc::is_finite(row.position) || !ipc::is_finite(row.velocity) ||
        !ipc::is_finite(row.acceleration)) {
      return ipc::AppendStatus::not_finite;
    }
    interval_ = row.time - last_;
    if (any_ && interval_ <= core::Time::zero()) return ipc::AppendStatus::not_increasing;
    if (any_ && !ipc::is_interval_in_range(interval_, limits_)) {
      return ipc::AppendStatus::interval_out_of_range;
    }
    any_ = true;
    last_ = row.time;
    return ipc::AppendStatus::accepted;
  }
  [[nodiscard]] core::Time interval() const { return interval_; }

 private:
  const WaypointTable* table_;
  ipc::IngestLimits limits_;
  bool any_ = false;
  core::Time last_{};
  core::Time interval_{};
};

/// Drops the rows that cannot be sent, with a message each, or throws for the first one.
ipc::Word drop_bad_rows(WaypointTable& table, const ReplayOptions& options) {
  WaypointTable good = table.without_rows();
  ipc::Word dropped = 0;
  RowCheck check(table, options);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto status = check.judge(i);
    if (status != ipc::AppendStatus::accepted) {
      const std::string message = refusal_message(table, i, status, check.interval());
      if (!options.skip_bad) throw InputError(message);
      say(message);
      ++dropped;
      continue;
    }
    good.append_row(table, i);
  }
  if (good.size() == 0) throw InputError(fmt::format("{}: no waypoint can be sent", table.file));
  table = std::move(good);
  return dropped;
}

/// A replay on its way: the producer, and the embedded solver if there is one.
class Replay {
 public:
  Replay(const WaypointTable& table, const ReplayOptions& options)
      : table_(table), options_(options), producer_(options.stream, producer_options()) {
    if (options.embedded) solver_.emplace(options.stream, options.solver);
  }

  ReplayReport run() {
    if (!await_solver()) return interrupted();
    const core::Time base = first_time();
    require_continuation(base);
    const core::Time shift = table_.times.back() - table_.times.front() + median_interval(table_);
    Progress progress;
    for (std::size_t loop = 0; loop < options_.loops; ++loop) {
      const core::Time offset = base - table_.times.front() + shift * static_cast<int>(loop);
      for (std::size_t i = 0; i < table_.size(); ++i) {
        if (!send(i, offset, progress)) return finish(), interrupted();
      }
    }
    finish();
    return await_consumption() ? report() : interrupted();
  }

 private:
  [[nodiscard]] ipc::ProducerOptions producer_options() const {
    const bool live = options_.clock == ipc::StreamClock::monotonic;
    const core::Condition start{
        .kind = live ? core::ConditionKind::halt : core::ConditionKind::natural, .value = {}};
    return {.dimensions = table_.dimensions(),
            .names = table_.names,
            .clock = options_.clock,
            .start = options_.start.value_or(start),
            .limits = options_.limits,
            .capacity = options_.capacity,
            .access = options_.access,
            .trust = options_.trust};
  }

  /// Lets the embedded solver work off what the ring holds.
  void solve() {
    if (!solver_) return;
    solver_->attach();
    while (solver_->step(clock_).consumed > 0) {
    }
  }

  /// Waits for a solver; false if a stop is requested meanwhile. Without one nothing is left
  /// behind.
  bool await_solver() {
    const core::Time end = clock_.now() + options_.wait;
    solve();
    while (!stop_requested()) {
      if (producer_.wait_for_solver(kSlice)) return true;
      if (clock_.now() < end) continue;
      withdraw_if_new();
      throw TimeOut(fmt::format("no solver for stream '{}' within {} s: run 'splinecast solve {}'",
                                options_.stream, core::to_seconds(options_.wait), options_.stream));
    }
    withdraw_if_new();
    return false;
  }

  void withdraw_if_new() noexcept {
    if (!producer_.continues()) producer_.withdraw();
  }

  /// Time of the first waypoint on the stream's clock.
  [[nodiscard]] core::Time first_time() const {
    return options_.clock == ipc::StreamClock::monotonic ? clock_.now() + options_.lead
                                                         : table_.times.front();
  }

  void require_continuation(core::Time first) const {
    if (!producer_.continues() || first > producer_.last_time()) return;
    throw InputError(fmt::format(
        "stream '{}' was left unfinished by its producer at {} ns; this recording begins at {} "
        "ns; 'splinecast rm {}' removes it",
        options_.stream, producer_.last_time().count(), first.count(), options_.stream));
  }

  /// Sends row i at its time. Returns false if a stop is requested.
  bool send(std::size_t i, core::Time offset, Progress& progress) {
    core::Waypoint waypoint = table_.waypoint(i);
    waypoint.time += offset;
    if (options_.rate && !pace(waypoint.time)) return false;
    for (;;) {
      const auto status = producer_.append(waypoint);
      if (status == ipc::AppendStatus::accepted) break;
      if (status != ipc::AppendStatus::full) {
        throw Failure(fmt::format("{}: waypoint refused: {} (time {} ns)", table_.where(i),
                                  ipc::to_string(status), waypoint.time.count()));
      }
      if (!await_room()) return false;
    }
    ++sent_;
    if (options_.rate) solve();
    if (i % 256 == 0 || options_.rate) {
      progress.show(fmt::format("{}: {} of {} waypoints", options_.stream, sent_,
                                table_.size() * options_.loops));
    }
    return true;
  }

  /// Sleeps until it is time to send: `lead` before a live waypoint's time, or, for a recorded
  /// stream, as long after the first one as it was recorded.
  bool pace(core::Time waypoint_time) {
    if (options_.clock == ipc::StreamClock::monotonic) {
      return sleep_until(waypoint_time - options_.lead);
    }
    if (sent_ == 0) recorded_start_ = clock_.now() - waypoint_time;
    return sleep_until(recorded_start_ + waypoint_time);
  }

  /// Waits while the solver has something to do; false if a stop is requested. A solver that lives
  /// may take its time; without one, only --wait.
  template <typename Wait>
  bool await(const Wait& wait) {
    core::Time end = clock_.now() + options_.wait;
    for (;;) {
      solve();
      if (wait()) return true;
      if (stop_requested()) return false;
      if (producer_.solver_alive()) {
        end = clock_.now() + options_.wait;
      } else if (clock_.now() >= end) {
        throw TimeOut(fmt::format("the solver of stream '{}' has gone and none came within {} s",
                                  options_.stream, core::to_seconds(options_.wait)));
      }
    }
  }
  bool await_room() {
    return await([this] { return producer_.wait_for_room(kSlice); });
  }
  bool await_consumption() {
    return await([this] { return producer_.wait_until_consumed(kSlice); });
  }

  void finish() {
    const core::Condition halt{.kind = core::ConditionKind::halt, .value = {}};
    while (producer_.finish(options_.end.value_or(halt)) == ipc::AppendStatus::full) {
      if (!await_room()) return;
    }
    solve();
  }

  ReplayReport interrupted() {
    ReplayReport result = report();
    result.interrupted = true;
    return result;
  }

  [[nodiscard]] ReplayReport report() const {
    ReplayReport result{.sent = sent_};
    if (!ipc::region_exists(options_.stream, ipc::RegionKind::spline)) return result;
    const ipc::StreamInfo info = ipc::inspect(options_.stream, options_.trust);
    result.interpolated = info.head.knots;
    result.refused = info.head.refused;
    return result;
  }

  const WaypointTable& table_;
  const ReplayOptions& options_;
  ipc::MonotonicClock clock_;
  ipc::Producer producer_;
  std::optional<ipc::Solver> solver_;
  core::Time recorded_start_{};
  ipc::Word sent_ = 0;
};

int run_replay(ReplayOptions options) {
  catch_stop_signals();
  ipc::Word unreadable = 0;
  if (options.skip_bad) {
    options.table.on_bad_row = [&unreadable](const InputError& error) {
      say(error.what());
      ++unreadable;
    };
  }
  ReplayReport report = replay_table(read_waypoints(options.file, options.table), options);
  report.skipped += unreadable;
  if (options.json) {
    const nlohmann::ordered_json json{{"stream", options.stream},
                                      {"sent", report.sent},
                                      {"interpolated", report.interpolated},
                                      {"refused", report.refused},
                                      {"skipped", report.skipped},
                                      {"interrupted", report.interrupted}};
    fmt::print("{}\n", json.dump(2));
  } else {
    say(fmt::format("'{}': {} waypoints sent, {} interpolated, {} refused, {} rows skipped{}",
                    options.stream, report.sent, report.interpolated, report.refused,
                    report.skipped, report.interrupted ? "; interrupted" : ""));
  }
  return kOk;
}

void add_playback_options(CLI::App& verb, ReplayOptions& options) {
  verb.add_option_function<std::string>(
          "--rate",
          [&options](const std::string& text) {
            const auto rate = parse_number(text);
            if (text != "max" && (!rate || !(*rate > 0) || !std::isfinite(*rate))) {
              throw CLI::ValidationError(
                  "--rate", fmt::format("'{}' is neither a positive number nor 'max'", text));
            }
            options.rate = rate;
          },
          "Play R times as fast as recorded (default 1), or as fast as it goes: max")
      ->type_name("R|max");
  verb.add_option("--loop", options.loops, "Play the recording N times (default 1)")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000}));
  add_seconds(verb, "--from", options.from, "Begin this long after the first waypoint");
  add_seconds(verb, "--duration", options.duration, "Play only so much of the recording");
  verb.add_option_function<std::string>(
          "--clock",
          [&options](const std::string& text) {
            if (text != "live" && text != "recorded") {
              throw CLI::ValidationError("--clock",
                                         fmt::format("'{}' is neither live nor recorded", text));
            }
            options.clock =
                text == "live" ? ipc::StreamClock::monotonic : ipc::StreamClock::recorded;
          },
          "live (default): now on this host's clock; recorded: the file's own stamps")
      ->type_name("CLOCK");
  add_milliseconds(verb, "--lead", options.lead,
                   "Append each waypoint of a live stream this long before its time (default 200)");
  add_condition(verb, "--start", options.start,
                "Condition at the first waypoint (default halt; natural if recorded)");
  add_condition(verb, "--end", options.end, "Condition at the last waypoint (default halt)");
}

void add_interval(CLI::App& verb, const std::string& name, core::Time& value,
                  const std::string& help) {
  verb.add_option_function<std::string>(
          name,
          [&value, name](const std::string& text) {
            const auto time = parse_time(text, TimeUnit::seconds);
            if (!time || *time <= core::Time::zero()) {
              throw CLI::ValidationError(name, fmt::format("'{}' is no positive time", text));
            }
            value = *time;
          },
          help)
      ->type_name("SECONDS");
}

}  // namespace

ReplayReport replay_table(WaypointTable table, const ReplayOptions& options) {
  select(table, options);
  scale(table, options.rate.value_or(1.0));
  const ipc::Word skipped = drop_bad_rows(table, options);
  const core::Condition none;
  core::require_values(options.start.value_or(none), table.dimensions());
  core::require_values(options.end.value_or(none), table.dimensions());
  ReplayReport report = Replay(table, options).run();
  report.skipped += skipped;
  return report;
}

void add_replay(CLI::App& program, Action& action) {
  auto options = std::make_shared<ReplayOptions>();
  auto* verb = program.add_subcommand("replay", "Send a recorded stream to a solver");
  verb->add_option("FILE", options->file, "Waypoint file, CSV or TUM text; - for standard input")
      ->required();
  verb->add_option("--stream", options->stream, "Stream to produce")->required();
  add_playback_options(*verb, *options);
  verb->add_option_function<std::string>(
          "--on-error",
          [options](const std::string& text) {
            if (text != "skip" && text != "stop") {
              throw CLI::ValidationError("--on-error",
                                         fmt::format("'{}' is neither skip nor stop", text));
            }
            options->skip_bad = text == "skip";
          },
          "What to do about a row that cannot be sent: stop (default), before anything is sent, or "
          "skip it")
      ->type_name("skip|stop");
  verb->add_option("--capacity", options->capacity,
                   "Waypoints that the ring holds (default 1024; rounded up to a power of two)")
      ->type_name("N");
  add_seconds(*verb, "--wait", options->wait, "Wait this long for a solver (default 10)");
  add_interval(*verb, "--min-interval", options->limits.min_interval,
               "Least time between waypoints (default 1e-6)");
  add_interval(*verb, "--max-interval", options->limits.max_interval,
               "Most time between waypoints (default 3600)");
  verb->add_flag("--embedded", options->embedded, "Solve in this process");
  add_settle(*verb, options->solver.settle);
  add_tail(*verb, options->solver.tail);
  verb->add_flag("--json", options->json, "Report as JSON on standard output");
  add_table_options(*verb, options->table);
  add_access(*verb, options->access);
  add_trust(*verb, options->trust);
  verb->callback([&action, options] {
    if (!options->embedded && (options->solver.settle || options->solver.tail)) {
      throw CLI::ValidationError("--settle, --tail", "go with --embedded; else tell 'solve'");
    }
    options->solver.access = options->access;
    options->solver.trust = options->trust;
    action = [options] { return run_replay(*options); };
  });
}

}  // namespace splinecast::apps
