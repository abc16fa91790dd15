#include <fmt/format.h>

#include <chrono>
#include <deque>
#include <optional>

#include "replay.hpp"
#include "splinecast/ipc/checked_region.hpp"
#include "splinecast/ipc/errors.hpp"
#include "splinecast/ipc/owner_lock.hpp"
#include "splinecast/ipc/producer.hpp"
#include "splinecast/ipc/stream_files.hpp"
#include "support/exit_codes.hpp"
#include "support/options.hpp"
#include "support/output.hpp"
#include "support/recording.hpp"
#include "support/refusal_watch.hpp"
#include "support/signals.hpp"
#include "support/stream_log.hpp"

namespace splinecast::apps {
namespace {

constexpr core::Time kSlice = std::chrono::milliseconds(50);

/// Throws BadRegion instead, if what stands under the board's name is what keeps a solver from it.
[[noreturn]] void throw_no_solver(const ReplayOptions& options) {
  if (ipc::region_exists(options.stream, ipc::RegionKind::spline)) {
    (void)ipc::open_board(options.stream, false, options.trust);
  }
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

/// The board that an embedded solver made for a ring that has been withdrawn.
void remove_board_without_ring(const ReplayOptions& options) {
  if (ipc::region_exists(options.stream, ipc::RegionKind::waypoints)) return;
  try {
    ipc::remove_stream(options.stream, options.trust);
  } catch (const ipc::StreamError&) {
    return;  // it was not made, or is somebody else's by now; what failed before is what is told
  }
}

/// All loops together may not take longer than times can say.
void require_loops(const WaypointTable& table, std::size_t loops) {
  if (loops == 1) return;
  const core::Time once = table.times.back() - table.times.front() + median_interval(table);
  const double seconds = static_cast<double>(loops) * core::to_seconds(once);
  if (seconds <= core::to_seconds(kLongestTime)) return;
  throw InputError(fmt::format("{}: --loop {} takes {} s; the most is {} s", table.file, loops,
                               seconds, core::to_seconds(kLongestTime)));
}

/// A replay on its way: the producer, and the embedded solver if there is one.
class Replay {
 public:
  Replay(const WaypointTable& table, const ReplayOptions& options, RefusedRows& refused)
      : table_(table),
        options_(options),
        refused_(refused),
        solver_(options.embedded
                    ? std::optional<ipc::Solver>(std::in_place, options.stream, options.solver)
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
    const core::Time base = first_time();
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
    watch_.emplace(options_.stream, producer_.stream_id(), options_.trust);
    before_ = watch_->head();
    if (options_.verify) begin_log();
    return true;
  }

  [[nodiscard]] std::size_t planned() const { return table_.size() * options_.loops; }

  /// Sends all loops; false if a stop is requested or a refused row stops it.
  bool play(core::Time base) {
    const core::Time shift = table_.times.back() - table_.times.front() + median_interval(table_);
    Progress progress;
    next_item_ = producer_.appended();
    for (std::size_t loop = 0; loop < options_.loops; ++loop) {
      const core::Time offset = base - table_.times.front() + shift * static_cast<int>(loop);
      for (std::size_t i = 0; i < table_.size(); ++i) {
        if (!send({.row = i, .loop = loop}, offset, progress)) return false;
      }
    }
    return true;
  }

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

  [[nodiscard]] core::Condition end() const { return options_.end.value_or(unasked()); }

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
      if (watch_) look_for_refusals();
    }
  }

  /// Waits for a solver; false if a stop is requested meanwhile.
  bool await_solver() {
    const core::Time end = ipc::deadline(clock_, options_.wait);
    solve();
    while (!stop_requested()) {
      if (producer_.wait_for_solver(kSlice)) return true;
      if (clock_.now() >= end) throw_no_solver(options_);
    }
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

  void require_continuation(core::Time first) const {
    if (!producer_.continues() || first > producer_.last_time()) return;
    throw InputError(fmt::format(
        "stream '{}' was left unfinished by its producer at {} ns; this recording begins at {} "
        "ns; 'splinecast rm {}' removes it, once its solver has been stopped",
        options_.stream, producer_.last_time().count(), first.count(), options_.stream));
  }

  /// Sends a row at its time. Returns false if a stop is requested or a refused row stops it.
  bool send(const Sent& next, core::Time offset, Progress& progress) {
    core::Waypoint waypoint = table_.waypoint(next.row);
    waypoint.time += offset;
    if (stop_requested() || (options_.rate && !pace(waypoint.time))) return false;
    ipc::AppendStatus status = producer_.append(waypoint);
    while (status == ipc::AppendStatus::full) {
      if (!await_room()) return false;
      status = producer_.append(waypoint);
    }
    if (status == ipc::AppendStatus::accepted) {
      ++sent_;
      in_ring_.push_back(next);
      if (log_) log_->sent(waypoint);
    } else {
      note_refusal(next, waypoint.time, status);
    }
    if (options_.rate) solve();
    look_for_refusals();
    if (next.row % 256 == 0 || options_.rate) {
      progress.show(fmt::format("{}: {} of {} waypoints", options_.stream, sent_, planned()));
    }
    return !stopped_;
  }

  /// What the append refused is not in the ring.
  void note_refusal(const Sent& row, core::Time time, ipc::AppendStatus status) {
    ++refused_by_producer_;
    note({.by = RefusedBy::producer,
          .reason = ipc::to_string(status),
          .line = table_.lines[row.row],
          .loop = row.loop + 1},
         fmt::format("{}: waypoint refused: {} (time {} ns)", table_.where(row.row),
                     ipc::to_string(status), time.count()));
  }

  /// What the solver refused stands on the board under its item's number, but not for ever: so this
  /// is called with every waypoint, and costs next to nothing where nothing was published since.
  void look_for_refusals() {
    if (log_) log_->look();
    watch_->look([this](const ipc::RefusedItem& item) { note_refusal(item); });
    const ipc::Word consumed = watch_->head().consumed;
    for (; next_item_ < consumed && !in_ring_.empty(); ++next_item_) in_ring_.pop_front();
  }

  void note_refusal(const ipc::RefusedItem& refused) {
    if (log_) log_->refused(refused.item);
    RefusedRow row{
        .by = RefusedBy::solver, .reason = ipc::to_string(refused.reason), .item = refused.item};
    std::string where = "the end";
    const ipc::Word i = refused.item - next_item_;
    if (i < in_ring_.size()) {
      row.line = table_.lines[in_ring_[i].row];
      row.loop = in_ring_[i].loop + 1;
      where = table_.where(in_ring_[i].row);
    }
    note(row, fmt::format("{}: waypoint refused by the solver: {} (item {})", where, row.reason,
                          refused.item));
  }

  void note(const RefusedRow& row, const std::string& message) {
    refused_.add(row, message);
    if (!options_.skip_bad && !stopped_) stopped_ = row.by;
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
      if (watch_) look_for_refusals();
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
    while (producer_.finish(end()) == ipc::AppendStatus::full) {
      if (!await_room()) return;
    }
    solve();
  }

  [[nodiscard]] ReplayReport report(bool complete) {
    look_for_refusals();
    refused_.add_unnamed(watch_->missed());
    const ipc::Head& now = watch_->head();
    ReplayReport report{.sent = sent_,
                        .unsent = planned() - sent_ - refused_by_producer_,
                        .interpolated = now.knots - before_.knots,
                        .refused = now.refused - before_.refused,
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
  ipc::MonotonicClock clock_;
  std::optional<ipc::Solver> solver_;  ///< first: if there is another one, nothing has been made
  ipc::Producer producer_;
  core::Time recorded_start_{};
  std::optional<RefusalWatch> watch_;  ///< once there is a board
  std::optional<StreamLog> log_;       ///< if it is to be verified
  ipc::Head before_;                   ///< what a producer left whose stream is continued
  std::deque<Sent> in_ring_;           ///< from item next_item_ on: not known to be consumed
  ipc::Word next_item_ = 0;
  ipc::Word sent_ = 0;
  ipc::Word refused_by_producer_ = 0;
  std::optional<RefusedBy> stopped_;  ///< who refused the row that stops it
};

}  // namespace

void prepare_replay(WaypointTable& table, const ReplayOptions& options, RefusedRows& refused) {
  select_rows(table, options.from.value_or(core::Time::zero()), options.duration);
  change_rate(table, options.rate.value_or(1.0));
  drop_unfit_rows(table, options.limits, options.skip_bad ? &refused : nullptr);
  require_loops(table, options.loops);
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
}

ReplayReport replay_table(const WaypointTable& table, const ReplayOptions& options,
                          RefusedRows& refused) {
  if (!options.embedded && !await_solver_of_finished(options)) {
    return {.unsent = table.size() * options.loops, .interrupted = true};
  }
  const bool had_board = ipc::region_exists(options.stream, ipc::RegionKind::spline);
  try {
    return Replay(table, options, refused).run();
  } catch (...) {
    if (options.embedded && !had_board) remove_board_without_ring(options);
    throw;
  }
}

}  // namespace splinecast::apps
