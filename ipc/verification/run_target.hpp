#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/online/sliding_window.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/verification/stream_record.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The target of a run, solved again: appends its waypoints one after the other, and freezes each
/// when the segments of the record show that the solver did. One run at a time; earlier knots stay
/// in the window, as in the solver. One thread uses it.
class RunTarget {
 public:
  /// The record outlives this. Throws std::invalid_argument for window options out of range.
  explicit RunTarget(const StreamRecord& record)
      : record_(record),
        window_(record.items.dimensions(), record.window),
        values_(3 * record.items.dimensions()) {}

  /// The spline through the waypoints appended so far.
  [[nodiscard]] const core::SlidingWindow& window() const noexcept { return window_; }

  /// Begins a run at another state than the one before.
  void begin_run() { window_.begin_run(); }

  /// Sets the position at which the current run begins, from which its values continue. Allocates.
  void begin_at(std::span<const double> position) {
    begin_position_.assign(position.begin(), position.end());
  }

  /// Clears the lists of a run: its waypoints, and those that the curve meets.
  void forget_waypoints() noexcept;

  /// Lists the waypoints of the run that begins with an item. A waypoint that is not after the one
  /// before it was not taken: it was withdrawn unread, with all items after it. Allocates.
  void list_waypoints(Word first);

  /// The index of the run's waypoint at a time; nothing if there is none. O(log n).
  [[nodiscard]] std::optional<std::size_t> index_of(Time time) const noexcept;

  /// Notes that the curve meets a waypoint of the run, and how many newer ones were known when that
  /// waypoint was last solved. Call in the order of time. Allocates.
  void note_met(std::size_t index, std::size_t newer);

  /// The index of the newest waypoint when a met one was last solved; nothing if the curve does not
  /// meet that one.
  [[nodiscard]] std::optional<std::size_t> newest_of(std::size_t index) const noexcept;

  /// Appends waypoints of the run until the window has `count` of them. Before each, freezes the
  /// knots that it did not change. Returns false if the run has fewer.
  [[nodiscard]] bool append_until(std::size_t count);

  /// Freezes the first waypoints of the run.
  void freeze(std::size_t count) noexcept { window_.freeze_knots(count); }

  /// Finishes the stream, if the window has all waypoints of the last run and is not finished.
  void finish_last_run() noexcept;

  /// Items before this one are known to the curve, or replaced.
  [[nodiscard]] Word used() const noexcept { return used_; }

 private:
  /// A knot of a run that the curve meets, and the newest knot when it was last solved.
  struct MetKnot {
    std::size_t index;
    std::size_t newest;
  };

  void append(Word item) noexcept;
  [[nodiscard]] std::span<const double> newest_position() const noexcept;

  const StreamRecord& record_;
  core::SlidingWindow window_;
  std::vector<double> values_;          ///< scratch
  std::vector<double> begin_position_;  ///< where the current run begins
  std::vector<Word> items_;             ///< of the current run's waypoints
  std::vector<MetKnot> met_;            ///< of the current run
  std::size_t frozen_met_ = 0;          ///< those of them that have been frozen
  Word used_ = 0;
};

}  // namespace splinecast::ipc
