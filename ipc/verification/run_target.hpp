#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/laws/rate_curve.hpp"
#include "core/motion/entry_end.hpp"
#include "core/motion/plan.hpp"
#include "core/online/sliding_window.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/verification/recorded_decisions.hpp"
#include "ipc/verification/stream_record.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

/// Makes the plan of a recorded run again: appends the run's waypoints one after the other, freezes
/// each knot when the segments of the record show that the solver froze it, and imposes the entries
/// and ends that they show. Searches for nothing; the plan's counts mean nothing. Holds one run at
/// a time. One thread uses it.
class RunTarget {
 public:
  /// The record and its replacements outlive this. Throws std::invalid_argument for window options
  /// out of range.
  RunTarget(const StreamRecord& record, const Replacements& replacements)
      : record_(record),
        replacements_(replacements),
        plan_(record.items.dimensions(), core::with_kinds(record.window, record.kinds)) {}

  [[nodiscard]] const core::Plan& plan() const noexcept { return plan_; }

  /// The spline through the waypoints appended so far.
  [[nodiscard]] const core::SlidingWindow& window() const noexcept { return plan_.window(); }

  /// Begins a new run in a state, or the same one in another state while it has no waypoints. The
  /// first waypoint is unwrapped to it, and the pieces of a law continue it.
  void begin_run(const Instant& state) noexcept { plan_.begin(state); }

  /// Clears the lists of a run: its waypoints, and those that the curve meets.
  void forget_waypoints() noexcept;

  /// Lists the waypoints of the run that begins with item `first`, up to the next replacement.
  /// Stops at a waypoint that is not later than the one before it: the solver has withdrawn it and
  /// the rest. If the item is a piece of a law, lists the waypoints of its plan. Allocates.
  void list_waypoints(Word first);

  /// Continues a run after knots that are not solved again, and lists its waypoints after these.
  /// Allocates.
  void restart(const RunRestart& restart);

  /// Regards the waypoints before an item as used.
  void skip_to(Word item) noexcept { used_ = item; }

  /// The index of the run's waypoint at a time; nothing if there is none. O(log n).
  [[nodiscard]] std::optional<std::size_t> index_of(Time time) const noexcept;

  /// Records that the curve meets a waypoint of the run, and how many newer ones were known when
  /// that waypoint was last solved. Call it in the order of time. Allocates.
  void note_met(std::size_t index, std::size_t newer);

  /// The index of the waypoint that was the newest one when waypoint `index` was last solved;
  /// nothing if the curve does not meet waypoint `index`.
  [[nodiscard]] std::optional<std::size_t> newest_of(std::size_t index) const noexcept;

  /// Appends waypoints of the run until the window has `count` of them. Before each append, freezes
  /// the knots that this waypoint did not change in the recorded stream: see note_met(). Returns
  /// false if the run has fewer than `count`, or has been finished with fewer.
  [[nodiscard]] bool append_until(std::size_t count);

  /// Makes an entry part of the plan, as its end was decided.
  void enter(const core::EntryEnd& end) noexcept { plan_.enter(end, std::nullopt); }

  /// Records that the curve has left the target at waypoint `index`, in the stop there.
  void leave_target_at(std::size_t index) noexcept { plan_.leave_target_at(index); }

  /// Ends the plan by an entry that comes to rest at its newest waypoint.
  void end_by_entry(Time rest) noexcept { plan_.end_by_entry(rest, std::nullopt); }

  /// Finishes the stream, if the window has all waypoints of the last run and is not finished.
  void finish_last_run() noexcept;

  /// The number after that of the last item that was appended: waypoints before it are on the
  /// target of a run, or were replaced.
  [[nodiscard]] Word used() const noexcept { return used_; }

 private:
  struct RunWaypoint {
    Time time;
    Word item;
    std::array<double, 3> of_plan{};  ///< of a law's plan: position, velocity, acceleration
  };
  /// A knot of a run that the curve meets, and the knot that was newest when it was last solved.
  struct MetKnot {
    std::size_t index;
    std::size_t newest;
  };

  void list_after(Word first, std::optional<Time> after);
  void list_plan(Word first, const core::LawState& from, std::size_t done);
  [[nodiscard]] Waypoint sent(const RunWaypoint& waypoint) const noexcept;

  const StreamRecord& record_;
  const Replacements& replacements_;
  core::Plan plan_;
  std::vector<RunWaypoint> waypoints_;  ///< of the current run
  std::size_t first_ = 0;               ///< number of the first of them in the run
  std::vector<MetKnot> met_;            ///< knots of the current run that the curve meets
  std::size_t frozen_met_ = 0;          ///< number of leading elements of met_ that are frozen
  Word used_ = 0;
};

}  // namespace splinecast::ipc
