#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "replay.hpp"
#include "splinecast/ipc/owner_lock.hpp"
#include "splinecast/ipc/producer.hpp"
#include "splinecast/ipc/stream_files.hpp"
#include "support/exit_codes.hpp"
#include "support/output.hpp"
#include "support/recording.hpp"
#include "support/signals.hpp"

namespace splinecast::apps {
namespace {

constexpr core::Time kSlice = std::chrono::milliseconds(50);

[[noreturn]] void throw_no_solver(const ReplayOptions& options) {
  throw TimeOut(fmt::format("no solver for stream '{}' within {} s: run 'splinecast solve {}'",
                            options.stream, core::to_seconds(options.wait), options.stream));
}

/// A finished stream is made anew only once there is a solver for the new one: until then its curve
/// can still be read. Returns false if a stop is requested meanwhile.
bool await_solver_of_finished(const ReplayOptions& options) {
  if (!ipc::region_exists(options.stream, ipc::RegionKind::spline)) return true;
  const ipc::MonotonicClock clock;
  const core::Time end = ipc::deadline(clock, options.wait);
  while (!ipc::is_owned(options.stream, ipc::RegionKind::spline)) {
    if (clock.now() >= end) throw_no_solver(options);
    if (!sleep_until(clock.now() + std::chrono::milliseconds(2))) return false;
  }
  return true;
}

/// A replay on its way: the producer, and the embedded solver if there is one.
class Replay {
 public:
  Replay(const WaypointTable& table, const ReplayOptions& options)
      : table_(table),
        options_(options),
        solver_(options.embedded
                    ? std::optional<ipc::Solver>(std::in_place, options.stream, options.solver)
                    : std::nullopt),
        producer_(options.stream, producer_options()) {}

  ReplayReport run() {
    if (!await_solver()) return {.interrupted = true};
    before_ = head();
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
    return {.dimensions = table_.dimensions(),
            .names = table_.names,
            .kinds = table_.kinds,
            .clock = options_.clock,
            .start = options_.start.value_or(unasked()),
            .limits = options_.limits,
            .capacity = options_.capacity,
            .access = options_.access,
            .trust = options_.trust};
  }

  /// The condition at an end that none was asked for.
  [[nodiscard]] core::Condition unasked() const {
    const bool live = options_.clock == ipc::StreamClock::monotonic;
    return {.kind = live ? core::ConditionKind::halt : core::ConditionKind::own, .value = {}};
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
    const core::Time end = ipc::deadline(clock_, options_.wait);
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
        "ns; 'splinecast rm {}' removes it, once its solver has been stopped",
        options_.stream, producer_.last_time().count(), first.count(), options_.stream));
  }

  /// Sends row i at its time. Returns false if a stop is requested.
  bool send(std::size_t i, core::Time offset, Progress& progress) {
    core::Waypoint waypoint = table_.waypoint(i);
    waypoint.time += offset;
    if (stop_requested() || (options_.rate && !pace(waypoint.time))) return false;
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
    core::Time end = ipc::deadline(clock_, options_.wait);
    for (;;) {
      solve();
      if (wait()) return true;
      if (stop_requested()) return false;
      if (producer_.solver_alive()) {
        end = ipc::deadline(clock_, options_.wait);
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
    while (producer_.finish(options_.end.value_or(unasked())) == ipc::AppendStatus::full) {
      if (!await_room()) return;
    }
    solve();
  }

  ReplayReport interrupted() {
    ReplayReport result = report();
    result.interrupted = true;
    return result;
  }

  /// The head of this very stream's board; revision 0 if it cannot be had.
  [[nodiscard]] ipc::Head head() const {
    if (!ipc::region_exists(options_.stream, ipc::RegionKind::spline)) return {};
    const ipc::StreamInfo info = ipc::inspect(options_.stream, options_.trust);
    const bool ours = info.spline && info.spline->stream_id == producer_.stream_id();
    return ours ? info.head : ipc::Head{};
  }

  [[nodiscard]] ReplayReport report() const {
    const ipc::Head now = head();
    ReplayReport report{.sent = sent_,
                        .interpolated = now.knots - before_.knots,
                        .refused = now.refused - before_.refused};
    for (std::size_t i = 0; i < report.refused_by_reason.size(); ++i) {
      report.refused_by_reason[i] = now.reasons[i] - before_.reasons[i];
    }
    return report;
  }

  const WaypointTable& table_;
  const ReplayOptions& options_;
  ipc::MonotonicClock clock_;
  std::optional<ipc::Solver> solver_;  ///< first: if there is another one, nothing has been made
  ipc::Producer producer_;
  core::Time recorded_start_{};
  ipc::Word sent_ = 0;
  ipc::Head before_;  ///< what a producer left whose stream is continued
};

}  // namespace

ipc::Word prepare_replay(WaypointTable& table, const ReplayOptions& options) {
  select_rows(table, options.from.value_or(core::Time::zero()), options.duration);
  change_rate(table, options.rate.value_or(1.0));
  const ipc::Word skipped = drop_unfit_rows(table, options.limits, options.skip_bad);
  const core::Condition none;
  core::require_values(options.start.value_or(none), table.dimensions());
  core::require_values(options.end.value_or(none), table.dimensions());
  core::DimensionKinds(table.kinds).require_end(options.end.value_or(none));
  for (const auto& condition : {options.start, options.end}) {
    if (condition && !core::is_online(condition->kind)) {
      throw InputError(
          fmt::format("condition '{}' needs all waypoints at once: a stream cannot "
                      "meet it",
                      core::to_string(*condition)));
    }
  }
  return skipped;
}

ReplayReport replay_table(const WaypointTable& table, const ReplayOptions& options) {
  if (!options.embedded && !await_solver_of_finished(options)) return {.interrupted = true};
  return Replay(table, options).run();
}

}  // namespace splinecast::apps
