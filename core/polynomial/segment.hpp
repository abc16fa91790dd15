#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/polynomial/chain_rule.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

/// Segments: polynomials local to their left knot, u = t − left in seconds.
///
/// Coefficients are laid out [power][dimension], lowest power first, so that loops run over
/// contiguous dimensions. Source: math 1.
namespace splinecast::core {

/// One polynomial piece of a curve with D dimensions.
struct Segment {
  /// Allocates 7·D doubles; nothing allocates afterwards.
  explicit Segment(std::size_t dimensions)
      : coefficients(static_cast<std::size_t>(kMaxOrder) * dimensions),
        acceleration_step(dimensions) {}

  Time left{};
  Time right{};
  int order = kCubicOrder;
  SegmentKind kind = SegmentKind::spline;
  std::vector<double> coefficients;       ///< [power][dimension]; powers ≥ order are unused
  std::vector<double> acceleration_step;  ///< a⁺ − a⁻ at the left knot, per dimension
};

/// Evaluates position, velocity, acceleration and jerk at u seconds after the left knot.
///
/// `coefficients` holds order·D values, 1 ≤ order ≤ kMaxPolynomialOrder; D is the size of each span
/// of `out`. Uses Horner's rule, with the same operations everywhere: the bits depend on the
/// arguments only. O(order·D). Never throws or allocates; safe from any thread.
void evaluate(int order, std::span<const double> coefficients, double u,
              const StateRef& out) noexcept;

/// The same by host time, at the instant at which a time law has these rates: `evaluate`, then
/// ChainRule. Bits as if these were called one after the other.
void evaluate(int order, std::span<const double> coefficients, double u, const LawRates& law,
              const StateRef& out) noexcept;

/// Value and first three derivatives of a polynomial of order kMaxOrder of one dimension, with the
/// operations, and so the bits, of `evaluate`.
[[nodiscard]] inline std::array<double, 4> evaluate_one(const double* coefficients,
                                                        double u) noexcept {
  const double* const c = coefficients;
  double position = c[5];
  double velocity = 5 * c[5];
  double acceleration = 20 * c[5];
  double jerk = 60 * c[5];
  position = position * u + c[4];
  velocity = velocity * u + 4 * c[4];
  acceleration = acceleration * u + 12 * c[4];
  jerk = jerk * u + 24 * c[4];
  position = position * u + c[3];
  velocity = velocity * u + 3 * c[3];
  acceleration = acceleration * u + 6 * c[3];
  jerk = jerk * u + 6 * c[3];
  position = position * u + c[2];
  velocity = velocity * u + 2 * c[2];
  acceleration = acceleration * u + 2 * c[2];
  position = position * u + c[1];
  velocity = velocity * u + c[1];
  return {position * u + c[0], velocity, acceleration, jerk};
}

/// Evaluates the derivative-th derivative (≥ 0; 0 is the position) at u seconds after the left
/// knot, with the operations, and so the bits, of `evaluate`. `out` takes D values. O(order·D).
/// Never throws or allocates; safe from any thread.
void evaluate_derivative(int order, std::span<const double> coefficients, double u, int derivative,
                         std::span<double> out) noexcept;

/// Evaluates the derivatives in `which` at many times, with the operations, and so the bits, of
/// `evaluate`.
///
/// `coefficients` holds order·dimensions values, 1 ≤ order ≤ kMaxPolynomialOrder; `u` holds seconds
/// after the left knot. Writes [time][derivative in `which`][dimension], with `stride` doubles from
/// one time to the next: at least count(which)·dimensions. `out` must have room for that many after
/// the start of the last time. Does not change the values in between. O(order·dimensions) per time.
/// Never throws or allocates; safe from any thread.
void evaluate_many(int order, std::span<const double> coefficients, std::size_t dimensions,
                   std::span<const double> u, Derivatives which, std::span<double> out,
                   std::size_t stride) noexcept;

/// An interval between two knots, with the solution at them. Spans hold one value per dimension. A
/// view: it owns nothing.
struct Interval {
  Time left{};
  Time right{};
  double h = 0;                    ///< length in seconds
  std::span<const double> x0;      ///< position at the left knot
  std::span<const double> chord;   ///< chord slope m = (x1 − x0)/h
  std::span<const double> v0, v1;  ///< knot velocities
  std::span<const double> a0, a1;  ///< knot accelerations; empty: those of the cubic
};

/// Writes the segment of an interval. Without knot accelerations, it is the cubic of the knot
/// velocities (math 2). With a knot acceleration at either end, it is the quintic with that
/// acceleration; at an end without one, it has the acceleration of the cubic. Sets everything
/// except `acceleration_step`.
void build_segment(const Interval& interval, Segment& out) noexcept;

/// Writes the one-sided accelerations of an interval's segment at its knots: D values, which must
/// not overlap those of the interval.
void write_left_acceleration(const Interval& interval, std::span<double> out) noexcept;
void write_right_acceleration(const Interval& interval, std::span<double> out) noexcept;

/// Writes the jump of the acceleration at the knot between two intervals: the acceleration at the
/// left end of `after` minus that at the right end of `before`. D values, as above.
void write_acceleration_jump(const Interval& before, const Interval& after,
                             std::span<double> out) noexcept;

/// Writes the segment that holds `position` between two times, which may be the same.
void build_hold(Time from, Time to, std::span<const double> position, Segment& out) noexcept;

/// Appends a segment to a curve; throws as PiecewisePolynomial::append does. Allocates.
void append(const Segment& segment, PiecewisePolynomial& curve);

}  // namespace splinecast::core
