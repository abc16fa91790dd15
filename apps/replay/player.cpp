#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/recordings/recording.hpp"
#include "apps/replay/lead.hpp"
#include "apps/replay/player.hpp"
#include "apps/streams/log.hpp"
#include "apps/streams/own_board.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/roles/old_motion.hpp"

#include "ipc/options/curve.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"

namespace splinecast::apps {
namespace {

constexpr Time kSlice = std::chrono::milliseconds(50);

/// Throws BadRegion instead, if what stands under the board's name is what keeps a solver from it.
[[noreturn]] void throw_no_solver(const ReplayOptions& options) {
  if (ipc::region_exists(options.stream, ipc::RegionKind::spline)) {
    (void)ipc::open_board(options.stream, false, options.trust);
  }
  throw TimeOut(fmt::format("no solver for stream '{}' within {} s: run 'splinecast solve {}'",
                            options.stream, to_seconds(options.wait), options.stream));
}

/// A finished stream is made again only once there is a solver for the new one: until then its
/// curve can still be read. Returns false if a stop is requested meanwhile.
bool await_solver_of_finished(const ReplayOptions& options) {
  if (!ipc::region_exists(options.stream, ipc::RegionKind::spline)) return true;
  const MonotonicClock clock;
  const Time end = deadline(clock, options.wait);
  while (!ipc::is_owned(options.stream, ipc::RegionKind::spline)) {
    if (clock.now() >= end) throw_no_solver(options);
    if (!sleep_until(clock.now() + std::chrono::milliseconds(2))) return false;
  }
  return true;
}

/// A replay on its way: the producer, and the embedded solver if there is one.
class Replay {
 public:
  Replay(const WaypointTable& table, const ReplayOptions& options, RefusedRows& refused)
      : table_(table),
        options_(options),
        refused_(refused),
        solver_(options.embedded
                    ? std::optional<Solver>(std::in_place, options.stream, options.solver)
                    : std::nullopt),
        producer_(options.stream, producer_options()) {}

  ReplayReport run() {
    try {
      if (!prepare()) return {.unsent = planned(), .interrupted = true};
    } catch (...) {
      withdraw_if_new();  // nothing has been sent: nothing is left behind
      throw;
    }
    if (!producer_.is_memory_locked() && !options_.quiet) {
      say(fmt::format("'{}': pages are not locked into memory (RLIMIT_MEMLOCK)", options_.stream));
    }
    const Time base = first_time();
    require_continuation(base);
    const bool played = play(base);
    finish();
    return report((played || stopped_) && await_consumption());
  }

 private:
  /// A waypoint in the ring, by what it was in the recording.
  struct Sent {
    std::size_t row;
    std::size_t loop;
  };

  /// Waits until there is a solver that has worked off what a producer before this one left, which
  /// is counted as none of ours. Returns false if a stop is requested meanwhile.
  bool prepare() {
    if (!await_solver()) {
      withdraw_if_new();
      return false;
    }
    if (!await_consumption()) return false;
    board_.emplace(options_.stream, producer_.stream_id(), options_.trust);
    before_ = board_->head();
    lead_ = choose_lead(table_, options_, board_->header());
    freeze_ahead_ = ipc::live_options(board_->header()).value_or(ipc::LiveOptions{}).freeze_ahead;
    producer_.refusals(found_);
    if (options_.verify) begin_log();
    return true;
  }

  [[nodiscard]] std::size_t planned() const { return table_.size() * options_.loops; }

  /// Sends all loops; false if a stop is requested or a refused row stops it.
  bool play(Time base) {
    const Time shift =
        saturated_sum(table_.times.back() - table_.times.front(), median_interval(table_));
    Progress progress;
    next_item_ = producer_.appended();
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

  /// The condition at an end that none was asked for.
  [[nodiscard]] Condition unasked() const {
    const bool live = options_.clock == StreamClock::monotonic;
    return {.kind = live ? ConditionKind::halt : ConditionKind::own, .value = {}};
  }

  /// Lets the embedded solver work off what the ring holds.
  void solve() {
    if (!solver_) return;
    solver_->attach();
    while (solver_->step(clock_).consumed > 0) {
      if (board_) look_for_refusals();
    }
  }

  /// Waits for a solver; false if a stop is requested meanwhile.
  bool await_solver() {
    const Time old = old_motion();
    const Time end = deadline(clock_, old + std::min(options_.wait, Time::max() - old));
    while (!stop_requested()) {
      solve();
      if (producer_.wait_for_solver(slice())) return true;
      if (clock_.now() >= end) throw_no_solver(options_);
    }
    return false;
  }

  /// How long the old motion of a stream that was made again still lasts: no solver takes the
  /// stream up before its end.
  [[nodiscard]] Time old_motion() const {
    const Time end = ipc::end_of_old_motion(options_.stream, producer_.stream_id(), options_.trust);
    const Time now = clock_.now();
    ipc::require_near_end(options_.stream, end, now);
    if (end <= now) return Time::zero();
    if (!options_.quiet) {
      say(fmt::format("'{}': waits {:.1f} s for the end of the earlier motion", options_.stream,
                      to_seconds(end - now)));
    }
    return end - now;
  }

  void withdraw_if_new() noexcept {
    if (!producer_.continues()) producer_.withdraw();
  }

  /// Time of the first waypoint on the stream's clock.
  [[nodiscard]] Time first_time() const {
    return options_.clock == StreamClock::monotonic ? clock_.now() + lead_ : table_.times.front();
  }

  /// What a producer before this one sent is not known, so that nothing behind it can be solved.
  void begin_log() {
    if (producer_.appended() > 0) {
      throw InputError(fmt::format(
          "stream '{}' was left unfinished by its producer, so that --verify lacks what it was "
          "sent; 'splinecast rm {}' removes it, once its solver has been stopped",
          options_.stream, options_.stream));
    }
    log_.emplace(options_.stream, producer_.stream_id(), options_.trust);
  }

  void require_continuation(Time first) const {
    if (!producer_.continues() || first > producer_.last_time()) return;
    throw InputError(fmt::format(
        "stream '{}' was left unfinished by its producer at {} ns; this recording begins at {} "
        "ns; 'splinecast rm {}' removes it, once its solver has been stopped",
        options_.stream, producer_.last_time().count(), first.count(), options_.stream));
  }

  /// Sends a row at its time. Returns false if a stop is requested or a refused row stops it.
  bool send(const Sent& next, Time offset, Progress& progress) {
    Waypoint waypoint = table_.waypoint(next.row);
    waypoint.time = saturated_sum(waypoint.time, saturated_sum(offset, late_.shifted));
    if (stop_requested() || (options_.rate && !pace(waypoint.time))) return false;
    const AppendStatus status = append_when_there_is_room(waypoint);
    if (status == AppendStatus::full) return false;
    if (status == AppendStatus::accepted) {
      ++sent_;
      in_ring_.push_back(next);
      if (log_) log_->sent(waypoint);
    } else {
      note_refusal(next, waypoint.time, status);
    }
    if (options_.rate || is_solver_due()) {
      solve();
      look_for_refusals();
    }
    if (next.row % 256 == 0 || options_.rate) {
      progress.show(fmt::format("{}: {} of {} waypoints", options_.stream, sent_, planned()));
    }
    return !stopped_;
  }

  /// Appends a waypoint, moved if it is late and to be shifted. Returns `full` if a stop is
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

  /// How much a waypoint is late that can be sent now: how long before the end of what settles now
  /// it lies; 0 if it does not. With `--late shift` it is given the lead again.
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

  /// Counts a waypoint that was late and moves those behind it as it was moved.
  void note_lateness(Time lateness, Time moved_by) {
    if (lateness == Time::zero()) return;
    late_.count(&LateRows::past, lateness);
    if (moved_by > Time::zero()) late_.shift(moved_by);
  }

  /// Appends a waypoint unless so many items before it are undecided that a refusal could be
  /// overwritten unseen. (In a ring of more items than the board keeps refusals, there may be
  /// more.)
  AppendStatus append(const Waypoint& waypoint) {
    look_for_refusals();
    const bool is_behind = producer_.appended() - found_.consumed >= ipc::kRefusalsKept &&
                           options_.capacity <= ipc::kRefusalsKept;
    if (!is_behind) return producer_.append(waypoint);
    (void)board_->head();  // throws if there is none: then nothing would become known any more
    return AppendStatus::full;
  }

  /// What the append refused is not in the ring.
  void note_refusal(const Sent& row, Time time, AppendStatus status) {
    ++refused_by_producer_;
    note({.by = RefusedBy::producer,
          .reason = to_string(status),
          .line = table_.lines[row.row],
          .loop = row.loop + 1},
         fmt::format("{}: waypoint refused: {} (time {} ns)", table_.where(row.row),
                     to_string(status), time.count()));
  }

  /// The board keeps the last refusals only: so this is called with every waypoint, and costs next
  /// to nothing where nothing was published since.
  void look_for_refusals() {
    if (log_) log_->look();
    producer_.refusals(found_);
    missed_ += found_.missed;
    for (const ItemRefusal& refused : found_.items) note_refusal(refused);
    for (; next_item_ < found_.consumed && !in_ring_.empty(); ++next_item_) in_ring_.pop_front();
  }

  void note_refusal(const ItemRefusal& refused) {
    if (log_) log_->refused(refused.item);
    RefusedRow row{
        .by = RefusedBy::solver, .reason = to_string(refused.reason), .item = refused.item};
    std::string where = "the end";
    const ipc::Word i = refused.item - next_item_;
    if (i < in_ring_.size()) {
      row.line = table_.lines[in_ring_[i].row];
      row.loop = in_ring_[i].loop + 1;
      where = table_.where(in_ring_[i].row);
    }
    std::string message = fmt::format("{}: waypoint refused by the solver: {} (item {})", where,
                                      row.reason, refused.item);
    if (refused.excess) {
      row.excess = refused.excess;
      message += ": " + in_words(*refused.excess, table_.names);
    }
    note(row, message);
  }

  void note(const RefusedRow& row, const std::string& message) {
    refused_.add(row, message);
    if (!options_.skip_bad && !stopped_) stopped_ = row.by;
  }

  /// Waits until it is time to send: `lead` before a live waypoint's time, or, for a recorded
  /// stream, as long after the first one as it was recorded.
  bool pace(Time waypoint_time) {
    if (options_.clock == StreamClock::monotonic) {
      return wait_until(waypoint_time - lead_);
    }
    if (sent_ == 0) recorded_start_ = clock_.now() - waypoint_time;
    return wait_until(recorded_start_ + waypoint_time);
  }

  /// Sleeps until an instant, but steps the embedded solver each time it is due. Returns false if a
  /// stop is requested.
  bool wait_until(Time instant) {
    if (!solver_) return sleep_until(instant);
    for (Time now = clock_.now(); now < instant; now = clock_.now()) {
      if (stop_requested()) return false;
      solve();
      solver_->wait(instant - now);
    }
    return !stop_requested();
  }

  [[nodiscard]] bool is_solver_due() const { return solver_ && solver_->due() <= clock_.now(); }

  /// Longest that this process may block: an embedded solver must be stepped by its due time.
  [[nodiscard]] Time slice() const {
    if (!solver_) return kSlice;
    return std::clamp(solver_->due() - clock_.now(), Time::zero(), kSlice);
  }

  /// Waits while the solver has something to do; false if a stop is requested. A solver that lives
  /// may take its time; without one, only --wait.
  template <typename Wait>
  bool await(const Wait& wait) {
    Time end = deadline(clock_, options_.wait);
    for (;;) {
      solve();
      if (board_) look_for_refusals();
      if (wait()) return true;
      if (stop_requested()) return false;
      if (producer_.solver_alive()) {
        end = deadline(clock_, options_.wait);
      } else if (clock_.now() >= end) {
        throw TimeOut(fmt::format("the solver of stream '{}' has gone and none came within {} s",
                                  options_.stream, to_seconds(options_.wait)));
      }
    }
  }
  bool await_room() {
    return await([this] { return producer_.wait_for_room(slice()); });
  }
  bool await_consumption() {
    return await([this] { return producer_.wait_until_consumed(slice()); });
  }

  void finish() {
    while (producer_.finish(end()) == AppendStatus::full) {
      if (!await_room()) return;
    }
    solve();
  }

  [[nodiscard]] ReplayReport report(bool complete) {
    look_for_refusals();
    refused_.add_unnamed(missed_);
    const ipc::Head now = board_->head();
    // Also if none of them could be named.
    if (now.refused > before_.refused && !options_.skip_bad && !stopped_) {
      stopped_ = RefusedBy::solver;
    }
    // An entry that was open before may have met waypoints since that were counted as passed over.
    const ipc::Word taken = now.knots - before_.knots;
    const ipc::Word passed_over =
        std::min(taken, now.passed_over - std::min(now.passed_over, before_.passed_over));
    ReplayReport report{.sent = sent_,
                        .unsent = planned() - sent_ - refused_by_producer_,
                        .interpolated = taken - passed_over,
                        .passed_over = passed_over,
                        .refused = now.refused - before_.refused,
                        .late = late_,
                        .stopped = stopped_,
                        .interrupted = !complete};
    for (std::size_t i = 0; i < report.refused_by_reason.size(); ++i) {
      report.refused_by_reason[i] = now.reasons[i] - before_.reasons[i];
    }
    if (log_) report.verification = log_->verify(end());
    return report;
  }

  const WaypointTable& table_;
  const ReplayOptions& options_;
  RefusedRows& refused_;
  MonotonicClock clock_;
  std::optional<Solver> solver_;  ///< first: if there is another one, nothing has been made
  Producer producer_;
  Time recorded_start_{};
  Time lead_{};
  Time freeze_ahead_{};
  LateRows late_;
  std::optional<OwnBoard> board_;  ///< once there is one
  Refusals found_;                 ///< by the last look
  ipc::Word missed_ = 0;
  std::optional<StreamLog> log_;  ///< if it is to be verified
  ipc::Head before_;              ///< what a producer left whose stream is continued
  std::deque<Sent> in_ring_;      ///< from item next_item_ on: not known to be consumed
  ipc::Word next_item_ = 0;
  ipc::Word sent_ = 0;
  ipc::Word refused_by_producer_ = 0;
  std::optional<RefusedBy> stopped_;  ///< who refused the row that stops it
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
