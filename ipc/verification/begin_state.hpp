#pragma once

#include <cstddef>
#include <span>

#include "ipc/board/segment.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/runs/run_edges.hpp"
#include "ipc/verification/stream_record.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Computes the state at which an entry, a stop or a hold of a record begins, from the segment
/// before it, with the same bits as the solver. Segments are counted from 0. One thread uses it.
class BeginState {
 public:
  /// The record outlives this.
  explicit BeginState(const StreamRecord& record)
      : record_(record),
        segments_(record.segments),
        state_(record.items.dimensions()),
        recorded_(record.items.dimensions()) {}

  /// Finds the state at which segment i, an entry or a stop, begins. By the rules 2 (see kRules) a
  /// solver decides with which acceleration an entry begins, at most that of the motion: it is read
  /// from the record. `natural_right`: where the segment before it ends without a cut. O(D).
  void find(std::size_t i, Time natural_right) noexcept;

  /// Sets the state to that of segment i at t, as if the curve were cut there. O(D).
  void take_cut(std::size_t i, Time t) noexcept;

  [[nodiscard]] std::span<const double> position() const noexcept { return state_.position(); }
  [[nodiscard]] std::span<const double> velocity() const noexcept { return state_.velocity(); }
  [[nodiscard]] std::span<const double> acceleration() const noexcept {
    return state_.acceleration();
  }

  /// The current state, with the time t attached: evaluates nothing. A view, valid until the next
  /// find() or take_cut().
  [[nodiscard]] Instant at(Time t) const noexcept {
    return {
        .time = t, .position = position(), .velocity = velocity(), .acceleration = acceleration()};
  }

 private:
  [[nodiscard]] static CutSegment cut_of(const SegmentCopy& segment) noexcept {
    return {segment.left, segment.right, segment.order, segment.coefficients};
  }
  void normalise() noexcept;
  void take_item(Word item) noexcept;
  void take_state_of(const SegmentCopy& segment) noexcept;
  [[nodiscard]] bool is_decided(const SegmentCopy& segment) const noexcept;
  void take_acceleration_of(const SegmentCopy& segment) noexcept;
  [[nodiscard]] bool is_state_of(const SegmentCopy& segment) noexcept;

  const StreamRecord& record_;
  std::span<const SegmentCopy> segments_;
  State state_;
  State recorded_;  ///< scratch
};

}  // namespace splinecast::ipc
