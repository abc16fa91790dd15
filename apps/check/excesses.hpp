#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "core/limits/check.hpp"
#include "splinecast/piecewise_polynomial.hpp"

namespace splinecast::apps {

/// An excess with its time on the curve.
struct TimedExcess {
  Excess excess;
  Time time{};
};

/// The comparison of a whole curve with limits.
struct CurveCheck {
  std::size_t segments = 0;
  std::size_t segments_beyond = 0;
  std::optional<TimedExcess> first_violation{};
  std::array<std::optional<TimedExcess>, kLimitKinds> worst{};  ///< by LimitKind
  /// The largest speed factor r ≤ 1 for which velocities r·v, accelerations r²·a and jerks r³·j
  /// keep their limits; 0 if there is none.
  double slowing = 1;
  bool keeps_bounds = true;  ///< the position is within its bounds; slowing does not change this

  [[nodiscard]] bool keeps_limits() const noexcept { return segments_beyond == 0; }
};

/// Compares every segment of the parts of a curve with limits that have passed require_limits.
/// Acceleration steps between segments do not count as jerk.
[[nodiscard]] CurveCheck check_curve(std::span<const PiecewisePolynomial> parts,
                                     const MotionLimits& limits, const DimensionKinds& kinds);

}  // namespace splinecast::apps
