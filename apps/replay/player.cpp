#include "apps/replay/player.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "apps/files/unit_of_name.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/replay/embedded_solver.hpp"
#include "apps/replay/lead.hpp"
#include "apps/replay/row_sender.hpp"
#include "apps/replay/sent_rows.hpp"
#include "apps/replay/solver_wait.hpp"
#include "apps/replay/start.hpp"
#include "apps/streams/own_board.hpp"
#include "ipc/options/curve.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"

namespace splinecast::apps {
namespace {

/// A running replay: the producer, and the embedded solver if there is one.
class Replay {
 public:
  Replay(Recording& recording, const ReplayOptions& options, RefusedRows& refused)
      : recording_(recording),
        options_(options),
        solver_(options, [this] { rows_.look_if_begun(); }),
        producer_(options.stream, producer_options()),
        rows_(recording, options, producer_, refused),
        sender_(options, solver_, producer_, rows_, recording.survey().gaps.count > 0) {}

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
    const bool played = play_to_end(base);
    if (!played && stop_requested() && is_live(options_.ring.clock)) sender_.stop_at_once();
    finish();
    return report((played || rows_.stopped()) && sender_.await_consumption());
  }

 private:
  /// Waits until a solver has consumed the items of an earlier producer, which the report does not
  /// count. Returns false if a stop is requested.
  bool prepare() {
    if (!await_solver()) {
      withdraw_if_new();
      return false;
    }
    if (!sender_.await_consumption()) return false;
    board_.emplace(options_.stream, producer_.stream_id(), options_.ring.trust);
    before_ = board_->summary();
    rows_.begin([this] { (void)board_->summary(); });
    sender_.set_lead(
        saturated_sum(choose_lead(recording_.survey(), options_, board_->header()), start()));
    return true;
  }

  /// Starts a new live stream where the machine is. Returns by how much the lead grows.
  Time start() {
    if (!is_live(options_.ring.clock) || producer_.continues()) return {};
    recording_.rewind();
    PreparedRow first;
    if (!recording_.next(first)) return {};
    return start_stream(producer_, options_.start_from, first.waypoint(), board_->header(), rows_);
  }

  [[nodiscard]] std::size_t planned() const { return recording_.survey().rows * options_.loops; }

  /// Plays all loops. Ends the stream if the recording can no longer be read.
  bool play_to_end(Time base) {
    try {
      return play(base);
    } catch (const InputError&) {
      const bool is_unused = rows_.sent() == 0 && !producer_.continues();
      is_unused ? producer_.withdraw() : finish();
      throw;
    }
  }

  /// Sends all loops; false if a stop is requested or a refused row stops it.
  bool play(Time base) {
    const Survey& survey = recording_.survey();
    const Time shift = saturated_sum(survey.last - survey.first, survey.median);
    Progress progress;
    for (std::size_t loop = 0; loop < options_.loops; ++loop) {
      const Time offset = saturated_sum(base - survey.first,
                                        saturated_product(shift, static_cast<std::int64_t>(loop)));
      recording_.rewind();
      for (PreparedRow row; recording_.next(row);) {
        Waypoint waypoint = row.waypoint();
        waypoint.time = saturated_sum(waypoint.time, offset);
        if (!sender_.send({.number = row.number, .loop = loop}, waypoint, row.follows_gap)) {
          return false;
        }
        show(progress);
        if (rows_.stopped()) return false;
      }
    }
    return true;
  }

  void show(Progress& progress) const {
    if (rows_.sent() % 256 != 0 && !options_.rate) return;
    progress.show(fmt::format("{}: {} of {} waypoints", options_.stream, rows_.sent(), planned()));
  }

  [[nodiscard]] ProducerOptions producer_options() const {
    ProducerOptions made = options_.ring;
    made.dimensions = recording_.columns().dimensions();
    made.names.clear();
    made.units.clear();
    made.kinds = recording_.kinds();
    made.start = options_.start.value_or(unasked());
    for (const std::string& column : recording_.columns().names) {
      auto [name, unit] = name_and_unit(column);
      made.names.push_back(std::move(name));
      made.units.push_back(std::move(unit));
    }
    // The times are counted from now: those that are far ahead are not of another clock either.
    made.horizon = Time::max();
    // The ring must accept the first waypoint after a gap.
    if (options_.gap.policy == GapPolicy::split) {
      made.limits.max_interval = std::max(made.limits.max_interval, recording_.survey().longest);
    }
    return made;
  }

  [[nodiscard]] Condition end() const {
    const Condition* given = condition_of(options_.end);
    return given != nullptr ? *given : unasked();
  }

  /// The default boundary condition: full stop on a live stream, else the method's own condition.
  [[nodiscard]] Condition unasked() const {
    const bool live = is_live(options_.ring.clock);
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
  [[nodiscard]] Time first_time() {
    return is_live(options_.ring.clock) ? producer_.now() + sender_.lead()
                                        : recording_.survey().first;
  }

  void require_continuation(Time first) const {
    if (!producer_.continues() || first > producer_.last_time()) return;
    throw InputError(fmt::format(
        "stream '{}' was left unfinished by its producer at {} ns; this recording begins at {} "
        "ns; 'splinecast rm {}' removes it, once its solver has been stopped",
        options_.stream, producer_.last_time().count(), first.count(), options_.stream));
  }

  void finish() {
    while (producer_.finish(end()) == AppendStatus::full) {
      if (!sender_.await_room()) return;
    }
    solver_.solve();
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
                        .late = sender_.late(),
                        .gaps = recording_.survey().gaps,
                        .end = now,
                        .stopped = stopped,
                        .interrupted = !complete};
    for (std::size_t i = 0; i < report.refused_by_reason.size(); ++i) {
      report.refused_by_reason[i] = now.reasons[i] - before_.reasons[i];
    }
    report.verification = rows_.verify(end());
    return report;
  }

  Recording& recording_;
  const ReplayOptions& options_;
  MonotonicClock clock_;
  EmbeddedSolver solver_;  ///< first: throws if there is another one, before a ring is created
  Producer producer_;
  SentRows rows_;
  RowSender sender_;
  std::optional<OwnBoard> board_;  ///< set once there is a board
  ipc::Summary before_;            ///< the summary when this replay began
};

}  // namespace

ReplayReport replay_recording(Recording& recording, const ReplayOptions& options,
                              RefusedRows& refused) {
  if (!await_law(options) || (!options.embedded && !await_solver_of_finished(options))) {
    return {.unsent = recording.survey().rows * options.loops, .interrupted = true};
  }
  const bool had_board = ipc::region_exists(options.stream, ipc::RegionKind::spline);
  try {
    return Replay(recording, options, refused).run();
  } catch (...) {
    if (options.embedded && !had_board)
      remove_board_without_ring(options.stream, options.ring.trust);
    throw;
  }
}

}  // namespace splinecast::apps
