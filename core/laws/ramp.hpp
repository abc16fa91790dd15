#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "splinecast/time.hpp"

/// Ramps of a time law: changes of its rate ṡ, the stream time that passes per host time, along
/// which s is twice continuously differentiable. Nothing allocates or throws. Source: math 31
/// and 32.
namespace splinecast::core {

/// The state of a law at one instant of host time.
struct LawState {
  Time time{};          ///< host time
  double position = 0;  ///< s: stream time since the law's origin [s]
  double rate = 1;      ///< ṡ, at least 0
  double slope = 0;     ///< s̈ [1/s]
};

/// The states at which the one or two parts of a ramp end. Each part is the quintic between two
/// such states, which is a quartic: its rate is a cubic.
class Ramp {
 public:
  [[nodiscard]] std::span<const LawState> ends() const noexcept {
    return std::span(ends_).first(parts_);
  }
  void add(const LawState& end) noexcept { ends_[parts_++] = end; }

 private:
  std::array<LawState, 2> ends_{};
  std::size_t parts_ = 0;
};

/// A ramp from a state to `rate`, from there on constant. `duration` is above 0, both rates are
/// within 0 and `largest`.
///
/// From a state with slope 0 it has one part: the rate is the cubic Hermite interpolant from one
/// rate to the other. Any other state is within another ramp. A first part then brings the slope to
/// 0 within a quarter of `duration`, or sooner where the rate would else pass 0 or `largest`; the
/// second part is the whole ramp. In both parts the rate is monotone, and the slope of the first
/// one never exceeds that at its start. Every time is rounded to nanoseconds. A first part shorter
/// than kShortestPart is badly conditioned: begin after the interrupted ramp instead.
[[nodiscard]] Ramp plan_ramp(const LawState& from, double rate, Time duration,
                             double largest) noexcept;

/// The length of the first part of that ramp; 0 if it has only one.
[[nodiscard]] Time first_part(const LawState& from, Time duration, double largest) noexcept;

/// See plan_ramp().
inline constexpr Time kShortestPart{1'000'000};

/// Largest magnitudes of the slope [1/s] and of its derivative [1/s²] along a ramp of one part,
/// from one constant rate to another.
struct RampPeaks {
  double slope = 0;
  double curvature = 0;
};
[[nodiscard]] RampPeaks peaks_of_ramp(double from, double to, Time duration) noexcept;

}  // namespace splinecast::core
