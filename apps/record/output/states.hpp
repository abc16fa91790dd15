#pragma once

#include <cstdint>

#include "core/polynomial/segment.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/header.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// How the settled curve is sampled.
struct SamplingRate {
  double hz = 0;  ///< 0: not sampled; else 1e-3 to 1e5
  /// Maximum number of states of a segment. A segment with more multiples of the interval is
  /// sampled at a multiple of it: the curve may rest for days, and waypoints may be hours apart.
  std::int64_t most = 1'000'000;
};

/// Samples the settled curve of a stream at a rate, with the bits of a reader: at the multiples of
/// an interval. One thread uses it.
class States {
 public:
  States(const ipc::RegionHeader& header, const SamplingRate& rate);

  /// Whether a segment with these ends has any sample.
  [[nodiscard]] bool has_any(Time left, Time right) const noexcept {
    return first_from(left, step_of(left, right)) < right;
  }

  /// Samples within [left, right) of the next settled segment: calls take(Time, const State&).
  template <typename Take>
  void sample(const ipc::SegmentCopy& segment, const Take& take) {
    const Time step = step_of(segment.left, segment.right);
    for (Time time = first_from(segment.left, step); time < segment.right; time += step) {
      core::evaluate(segment.order, segment.coefficients, to_seconds(time - segment.left),
                     state_.ref());
      kinds_.normalise(state_.ref());
      take(time, state_);
    }
  }

 private:
  [[nodiscard]] Time step_of(Time left, Time right) const noexcept;
  /// The first multiple of a step at or after a time.
  [[nodiscard]] static Time first_from(Time time, Time step) noexcept;

  DimensionKinds kinds_;
  Time interval_;
  std::int64_t most_;
  State state_;
};

}  // namespace splinecast::apps::record
