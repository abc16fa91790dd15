#pragma once

#include <cstddef>
#include <span>

#include "ipc/board/segment.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/solve/run_edges.hpp"
#include "ipc/verification/stream_record.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The state at which an entry, a stop or a hold of a record begins: that of the curve before it,
/// as the solver had it. Segments are counted from 0. One thread uses it.
class BeginState {
 public:
  /// The record outlives this.
  explicit BeginState(const StreamRecord& record)
      : record_(record), segments_(record.segments), state_(record.items.dimensions()) {}

  /// Finds the state at which the entry, or the stop, of segment i begins. `natural_right`: where
  /// the segment before would end without a cut. O(D).
  void find(std::size_t i, Time natural_right) noexcept;

  /// Takes the state of segment i at a time, regardless of the segments after it. O(D).
  void take_cut(std::size_t i, Time t) noexcept;

  [[nodiscard]] std::span<const double> position() const noexcept { return state_.position(); }
  [[nodiscard]] std::span<const double> velocity() const noexcept { return state_.velocity(); }
  [[nodiscard]] std::span<const double> acceleration() const noexcept {
    return state_.acceleration();
  }

  /// The state at a time; a view, valid until the state changes.
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
  [[nodiscard]] bool is_state_of(const SegmentCopy& segment) const;

  const StreamRecord& record_;
  std::span<const SegmentCopy> segments_;
  State state_;
};

}  // namespace splinecast::ipc
