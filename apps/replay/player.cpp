#include "apps/replay/player.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/recordings/selection.hpp"
#include "apps/replay/embedded_solver.hpp"
#include "apps/replay/lead.hpp"
#include "apps/replay/sent_rows.hpp"
#include "apps/replay/solver_wait.hpp"
#include "apps/streams/own_board.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"

namespace splinecast::apps {
namespace {

/// A running replay: the producer, and the embedded solver if there is one.
class Replay {
 public:
  Replay(const WaypointTable& table, const ReplayOptions& options, RefusedRows& refused)
      : table_(table),
        options_(options),
        solver_(options, [this] { look_for_refusals(); }),
        producer_(options.stream, producer_options()),
        rows_(table, options, producer_, refused) {}

  ReplayReport run() {
    try {
      if (!prepare()) return {.unsent = planned(), .interrupted = true};
    } catch (...) {
      withdraw_if_new();  // nothing has been sent: removes a new stream
      throw;
    }
    if (!producer_.is_memory_locked() && !options_.quiet) {
      say(fmt::format("'{}': pages are not locked into memory (RLIMIT_MEMLOCK)", options_.stream));
    }
    const Time base = first_time();
    require_continuation(base);
    const bool played = play(base);
    finish();
    return report((played || rows_.stopped()) && await_consumption());
  }

 private:
  /// Waits until a solver has consumed the items of an earlier producer, which the report does not
  /// count. Returns false if a stop is requested.
  bool prepare() {
    if (!await_solver()) {
      withdraw_if_new();
      return false;
    }
    if (!await_consumption()) return false;
    board_.emplace(options_.stream, producer_.stream_id(), options_.trust);
    before_ = board_->summary();
    lead_ = choose_lead(table_, options_, board_->header());
    freeze_ahead_ = ipc::live_options(board_->header()).value_or(ipc::LiveOptions{}).freeze_ahead;
    rows_.begin();
    return true;
  }

  [[nodiscard]] std::size_t planned() const { return table_.size() * options_.loops; }

  /// Sends all loops; false if a stop is requested or a refused row stops it.
  bool play(Time base) {
    const Time shift =
        saturated_sum(table_.times.back() - table_.times.front(), median_interval(table_));
    Progress progress;
    rows_.begin_rows();
    for (std::size_t loop = 0; loop < options_.loops; ++loop) {
      const Time offset = saturated_sum(base - table_.times.front(),
                                        saturated_product(shift, static_cast<std::int64_t>(loop)));
      for (std::size_t i = 0; i < table_.size(); ++i) {
        if (!send({.row = i, .loop = loop}, offset, progress)) return false;
      }
    }
    return true;
  }

  [[nodiscard]] ProducerOptions producer_options() const {
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

  [[nodiscard]] Condition end() const { return options_.end.value_or(unasked()); }

  /// The default boundary condition: full stop on a live stream, else the method's own condition.
  [[nodiscard]] Condition unasked() const {
    const bool live = options_.clock == StreamClock::monotonic;
    return {.kind = live ? ConditionKind::halt : ConditionKind::own, .value = {}};
  }

  /// Waits for a solver; false if a stop is requested.
  bool await_solver() {
    const Time old = rest_of_old_motion(options_, producer_.stream_id());
    const Time end = deadline(clock_, old + std::min(options_.wait, Time::max() - old));
    while (!stop_requested()) {
      solver_.solve();
      if (producer_.wait_for_solver(solver_.slice())) return true;
      if (clock_.now() >= end) throw_no_solver(options_);
    }
    return false;
  }

  void withdraw_if_new() noexcept {
    if (!producer_.continues()) producer_.withdraw();
  }

  /// Time of the first waypoint on the stream's clock.
  [[nodiscard]] Time first_time() const {
    return options_.clock == StreamClock::monotonic ? clock_.now() + lead_ : table_.times.front();
  }

  void require_continuation(Time first) const {
    if (!producer_.continues() || first > producer_.last_time()) return;
    throw InputError(fmt::format(
        "stream '{}' was left unfinished by its producer at {} ns; this recording begins at {} "
        "ns; 'splinecast rm {}' removes it, once its solver has been stopped",
        options_.stream, producer_.last_time().count(), first.count(), options_.stream));
  }

  /// Sends a row at its time. Returns false if a stop is requested or a refused row stops it.
  bool send(const PlayedRow& next, Time offset, Progress& progress) {
    Waypoint waypoint = table_.waypoint(next.row);
    waypoint.time = saturated_sum(waypoint.time, saturated_sum(offset, late_.shifted));
    if (stop_requested() || (options_.rate && !pace(waypoint.time))) return false;
    const AppendStatus status = append_when_there_is_room(waypoint);
    if (status == AppendStatus::full) return false;
    if (status == AppendStatus::accepted) {
      rows_.note_sent(next, waypoint);
    } else {
      rows_.note_refusal(next, waypoint.time, status);
    }
    if (options_.rate || solver_.is_due()) {
      solver_.solve();
      rows_.look();
    }
    if (next.row % 256 == 0 || options_.rate) {
      progress.show(
          fmt::format("{}: {} of {} waypoints", options_.stream, rows_.sent(), planned()));
    }
    return !rows_.stopped();
  }

  /// Appends a waypoint, with `--late shift` moved if it is late. Returns `full` if a stop is
  /// requested while it waits for room.
  AppendStatus append_when_there_is_room(Waypoint& waypoint) {
    const Time intended = waypoint.time;
    Time lateness = shift_if_late(waypoint);
    AppendStatus status = append(waypoint);
    while (status == AppendStatus::full) {
      if (stop_requested() || !await_room()) return status;
      lateness = std::max(lateness, shift_if_late(waypoint));
      status = append(waypoint);
    }
    note_lateness(lateness, waypoint.time - intended);
    return status;
  }

  /// Returns the lateness of a waypoint that is sent now: the time from the waypoint to the settled
  /// time, 0 if the waypoint is later. With `--late shift`, moves a late waypoint to `lead` after
  /// now.
  Time shift_if_late(Waypoint& waypoint) {
    if (options_.clock != StreamClock::monotonic) return {};
    const Time now = clock_.now();
    const Time settled = std::max(producer_.earliest(), now + freeze_ahead_);
    const Time lateness = std::max(settled - waypoint.time, Time::zero());
    if (lateness > Time::zero() && options_.late == LatePolicy::shift) {
      waypoint.time = std::max(waypoint.time, now + lead_);
    }
    return lateness;
  }

  /// Counts a late waypoint. If it was moved, moves all later ones by the same time.
  void note_lateness(Time lateness, Time moved_by) {
    if (lateness == Time::zero()) return;
    late_.count(&LateRows::past, lateness);
    if (moved_by > Time::zero()) late_.shift(moved_by);
  }

  /// Appends a waypoint. Returns `full` while kRefusalsKept earlier items are undecided, because
  /// the board could overwrite a refusal before it is read. A ring of more than kRefusalsKept items
  /// is not throttled.
  AppendStatus append(const Waypoint& waypoint) {
    rows_.look();
    const bool is_behind =
        rows_.undecided() >= ipc::kRefusalsKept && options_.capacity <= ipc::kRefusalsKept;
    if (!is_behind) return producer_.append(waypoint);
    (void)board_->summary();  // throws if there is no summary: no refusal can be read
    return AppendStatus::full;
  }

  /// Waits until it is time to send: on a live stream `lead` before the waypoint's time, on a
  /// recorded stream at the recorded time after the first waypoint.
  bool pace(Time waypoint_time) {
    if (options_.clock == StreamClock::monotonic) {
      return solver_.wait_until(waypoint_time - lead_);
    }
    if (rows_.sent() == 0) recorded_start_ = clock_.now() - waypoint_time;
    return solver_.wait_until(recorded_start_ + waypoint_time);
  }

  /// Waits while the solver has work to do; false if a stop is requested. Waits for a live solver
  /// without limit, for a new one at most --wait.
  template <typename Wait>
  bool await(const Wait& wait) {
    Time end = deadline(clock_, options_.wait);
    for (;;) {
      solver_.solve();
      look_for_refusals();
      if (wait()) return true;
      if (stop_requested()) return false;
      if (producer_.solver_alive()) {
        end = deadline(clock_, options_.wait);
      } else if (clock_.now() >= end) {
        throw TimeOut(
            fmt::format("the solver of stream '{}' has ended and no other attached within {} s",
                        options_.stream, to_seconds(options_.wait)));
      }
    }
  }
  bool await_room() {
    return await([this] { return producer_.wait_for_room(solver_.slice()); });
  }
  bool await_consumption() {
    return await([this] { return producer_.wait_until_consumed(solver_.slice()); });
  }

  void finish() {
    while (producer_.finish(end()) == AppendStatus::full) {
      if (!await_room()) return;
    }
    solver_.solve();
  }

  /// Reads new refusals. Before there is a board, there are none.
  void look_for_refusals() {
    if (board_) rows_.look();
  }

  [[nodiscard]] ReplayReport report(bool complete) {
    rows_.finish();
    const ipc::Summary now = board_->summary();
    // The solver may have refused rows of which none could be named.
    std::optional<RefusedBy> stopped = rows_.stopped();
    if (now.refused > before_.refused && !options_.skip_bad && !stopped) {
      stopped = RefusedBy::solver;
    }
    // `passed_over` can decrease: an entry that was open at the beginning of this replay may have
    // reached waypoints that were counted as passed over.
    const ipc::Word taken = now.knots - before_.knots;
    const ipc::Word passed_over =
        std::min(taken, now.passed_over - std::min(now.passed_over, before_.passed_over));
    ReplayReport report{.sent = rows_.sent(),
                        .unsent = planned() - rows_.sent() - rows_.refused_by_producer(),
                        .interpolated = taken - passed_over,
                        .passed_over = passed_over,
                        .refused = now.refused - before_.refused,
                        .late = late_,
                        .stopped = stopped,
                        .interrupted = !complete};
    for (std::size_t i = 0; i < report.refused_by_reason.size(); ++i) {
      report.refused_by_reason[i] = now.reasons[i] - before_.reasons[i];
    }
    report.verification = rows_.verify(end());
    return report;
  }

  const WaypointTable& table_;
  const ReplayOptions& options_;
  MonotonicClock clock_;
  EmbeddedSolver solver_;  ///< first: throws if there is another one, before a ring is created
  Producer producer_;
  SentRows rows_;
  Time recorded_start_{};
  Time lead_{};
  Time freeze_ahead_{};
  LateRows late_;
  std::optional<OwnBoard> board_;  ///< set once there is a board
  ipc::Summary before_;            ///< the summary when this replay began
};

}  // namespace

ReplayReport replay_table(const WaypointTable& table, const ReplayOptions& options,
                          RefusedRows& refused) {
  if (!options.embedded && !await_solver_of_finished(options)) {
    return {.unsent = table.size() * options.loops, .interrupted = true};
  }
  const bool had_board = ipc::region_exists(options.stream, ipc::RegionKind::spline);
  try {
    return Replay(table, options, refused).run();
  } catch (...) {
    if (options.embedded && !had_board) remove_board_without_ring(options.stream, options.trust);
    throw;
  }
}

}  // namespace splinecast::apps
