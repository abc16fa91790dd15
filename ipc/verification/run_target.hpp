#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/laws/rate_curve.hpp"
#include "core/online/sliding_window.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/verification/recorded_decisions.hpp"
#include "ipc/verification/stream_record.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

/// Solves the target of a run again: appends its waypoints one after the other, and freezes each
/// knot when the segments of the record show that the solver froze it. Holds one run at a time. One
/// thread uses it.
class RunTarget {
 public:
  /// The record and its replacements outlive this. Throws std::invalid_argument for window options
  /// out of range.
  RunTarget(const StreamRecord& record, const Replacements& replacements)
      : record_(record),
        replacements_(replacements),
        window_(record.items.dimensions(), core::with_kinds(record.window, record.kinds)),
        values_(3 * record.items.dimensions()),
        begin_(record.items.dimensions()) {}

  /// The spline through the waypoints appended so far.
  [[nodiscard]] const core::SlidingWindow& window() const noexcept { return window_; }

  /// Begins a new run, which continues from a given state: see begin_at().
  void begin_run() { window_.begin_run(); }

  /// Sets the state in which the current run begins. The first waypoint is unwrapped to it, and
  /// the pieces of a law continue it.
  void begin_at(const Instant& state) noexcept;

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
  /// false if the run has fewer than `count`.
  [[nodiscard]] bool append_until(std::size_t count);

  /// Freezes the first `count` waypoints of the run.
  void freeze(std::size_t count) noexcept { window_.freeze_knots(count); }

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
  void append(const RunWaypoint& waypoint) noexcept;
  [[nodiscard]] std::span<const double> newest_position() const noexcept;

  const StreamRecord& record_;
  const Replacements& replacements_;
  core::SlidingWindow window_;
  std::vector<double> values_;  ///< scratch
  State begin_;                 ///< in which the current run begins
  Time begin_time_{};
  std::vector<RunWaypoint> waypoints_;  ///< of the current run
  std::size_t first_ = 0;               ///< number of the first of them in the run
  std::vector<MetKnot> met_;            ///< knots of the current run that the curve meets
  std::size_t frozen_met_ = 0;          ///< number of leading elements of met_ that are frozen
  Word used_ = 0;
};

}  // namespace splinecast::ipc
