#pragma once

#include <cstddef>

#include "splinecast/piecewise_polynomial.hpp"

/// Operations on curves, and measures of curves.
///
/// A function that returns a curve returns a new one, in O(n·k·D). A hold is a valid argument. All
/// functions throw std::invalid_argument with the offending values; measures also throw for an
/// empty curve and for a dimension, derivative or time out of range.
namespace [[gnu::visibility("default")]] splinecast {

/// The derivative: each order decreases by one; order 1 becomes the constant 0.
[[nodiscard]] PiecewisePolynomial differentiated(const PiecewisePolynomial& curve);

/// The continuous integral that is 0 at the first break: each order increases by one. Throws if an
/// order would exceed kMaxPolynomialOrder.
[[nodiscard]] PiecewisePolynomial integrated(const PiecewisePolynomial& curve);

/// The part of a curve between two times, first break ≤ from ≤ to ≤ last break, which may be inside
/// segments. A segment cut on its left is re-expanded there (Taylor shift); all others keep their
/// bits. With from = to the result is a hold. Throws for times outside or out of order.
[[nodiscard]] PiecewisePolynomial restricted(const PiecewisePolynomial& curve, Time from, Time to);

/// The same curve with every segment of order `order`, padded with zero coefficients. Throws if
/// `order` is less than curve.order() or more than kMaxPolynomialOrder.
[[nodiscard]] PiecewisePolynomial raised(const PiecewisePolynomial& curve, int order);

/// A value and the time at which it is reached; the time is rounded to the nanosecond, the value is
/// not.
struct Extremum {
  Time time{};
  double value = 0;
};

/// The minimum and the maximum, each at the earliest time at which it is reached.
struct Extremes {
  Extremum least;
  Extremum greatest;
};

/// The minimum and the maximum of one dimension of a derivative (0 position [unit], 1 velocity, 2
/// acceleration, 3 jerk, or higher) over the whole curve. At a jump both one-sided values count, at
/// the same time. Exact to rounding: takes the values at the roots of the next derivative and at
/// the ends of every segment. O(n·k³); does not allocate.
[[nodiscard]] Extremes extremes(const PiecewisePolynomial& curve, std::size_t dimension,
                                int derivative);

/// The same over one segment, closed at both ends.
[[nodiscard]] Extremes extremes_of_segment(const PiecewisePolynomial& curve, std::size_t segment,
                                           std::size_t dimension, int derivative);

}  // namespace splinecast
