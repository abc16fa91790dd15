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

/// The target of a run, solved again: its waypoints one after the other, each frozen when the
/// segments of the record say that it was. One run at a time; what came before it stays in the
/// window, as in the solver. One thread uses it.
class RunTarget {
 public:
  /// The record outlives this. Throws std::invalid_argument for window options out of range.
  explicit RunTarget(const StreamRecord& record)
      : record_(record),
        window_(record.items.dimensions(), record.window),
        values_(3 * record.items.dimensions()) {}

  /// The spline through the waypoints appended so far.
  [[nodiscard]] const core::SlidingWindow& window() const noexcept { return window_; }

  /// Begins a run in another state than the one before.
  void begin_run() { window_.begin_run(); }

  /// Says where the present run begins, for values that continue from there. Allocates.
  void begin_at(std::span<const double> position) {
    begin_position_.assign(position.begin(), position.end());
  }

  /// Drops what is listed of a run: its waypoints, and those that the curve meets.
  void forget_waypoints() noexcept;

  /// Lists the waypoints of the run that begins with an item. One that is not later than the one
  /// before was not taken, but withdrawn unread with all behind it. Allocates.
  void list_waypoints(Word first);

  /// The waypoint of the run at a time; nothing if there is none. O(log n).
  [[nodiscard]] std::optional<std::size_t> index_of(Time time) const noexcept;

  /// Notes that the curve meets a waypoint of the run, and how many newer ones that had seen when
  /// it was last solved: in the order of time. Allocates.
  void note_met(std::size_t index, std::size_t newer);

  /// The newest waypoint when a met one was last solved; nothing if that is not met.
  [[nodiscard]] std::optional<std::size_t> newest_of(std::size_t index) const noexcept;

  /// Appends waypoints of the run until the window has `count` of them, and freezes before each
  /// what it did not change. Returns false if the run has fewer.
  [[nodiscard]] bool append_until(std::size_t count);

  /// Freezes the first waypoints of the run.
  void freeze(std::size_t count) noexcept { window_.freeze_knots(count); }

  /// Finishes the stream, if this has all waypoints of the last run and has not been finished.
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
  std::vector<double> begin_position_;  ///< where the present run begins
  std::vector<Word> items_;             ///< of the present run's waypoints
  std::vector<MetKnot> met_;            ///< of the present run
  std::size_t frozen_met_ = 0;          ///< those of them that have been frozen
  Word used_ = 0;
};

}  // namespace splinecast::ipc
