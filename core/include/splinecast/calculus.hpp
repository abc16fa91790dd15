#pragma once

#include <cstddef>
#include <vector>

#include "splinecast/piecewise_polynomial.hpp"

/// Curves made from curves, and what can be measured on a curve.
///
/// A function that returns a curve makes a new one in O(n·k·D); a hold is a curve like any other.
/// All functions throw std::invalid_argument with the offending values; those that measure also do
/// for an empty curve and for a dimension, derivative or time out of range.
namespace [[gnu::visibility("default")]] splinecast {

/// The derivative: each order falls by one, order 1 becomes the constant 0.
[[nodiscard]] PiecewisePolynomial differentiated(const PiecewisePolynomial& curve);

/// The integral that is 0 at the first break and continuous: each order rises by one. Throws if one
/// would pass kMaxPolynomialOrder.
[[nodiscard]] PiecewisePolynomial integrated(const PiecewisePolynomial& curve);

/// The curve between two times, first break ≤ from ≤ to ≤ last break, which may lie inside
/// segments. A segment cut on its left is re-expanded there (Taylor shift); all others keep their
/// bits. With from = to it is a hold. Throws for times outside or out of order.
[[nodiscard]] PiecewisePolynomial restricted(const PiecewisePolynomial& curve, Time from, Time to);

/// Curve `a` followed by `b`, both with their bits. Throws unless both have the same dimensions and
/// b begins where a ends. A curve that is empty or a hold adds nothing to the other.
[[nodiscard]] PiecewisePolynomial concatenated(const PiecewisePolynomial& a,
                                               const PiecewisePolynomial& b);

/// The curve `by` later; no coefficient changes.
[[nodiscard]] PiecewisePolynomial shifted(const PiecewisePolynomial& curve, Time by);

/// The same curve with every segment of order `order`, padded with zero coefficients. Throws if
/// that is less than curve.order() or more than kMaxPolynomialOrder.
[[nodiscard]] PiecewisePolynomial raised(const PiecewisePolynomial& curve, int order);

/// A value and where it is reached; the time is rounded to the nanosecond, the value is not.
struct Extremum {
  Time time{};
  double value = 0;
};

/// The earliest least and the earliest greatest value.
struct Extremes {
  Extremum least;
  Extremum greatest;
};

/// The least and the greatest value of one dimension of a derivative (0 position [unit], 1
/// velocity, 2 acceleration, 3 jerk, any above) over the whole curve. At a jump both one-sided
/// values count, at one time. Exact to rounding: the values at the roots of the next derivative and
/// at the ends of every segment. O(n·k³); does not allocate.
[[nodiscard]] Extremes extremes(const PiecewisePolynomial& curve, std::size_t dimension,
                                int derivative);

/// The same over one segment, closed at both ends.
[[nodiscard]] Extremes extremes_of_segment(const PiecewisePolynomial& curve, std::size_t segment,
                                           std::size_t dimension, int derivative);

/// The times, ascending and each once, at which a dimension's position crosses or touches a value,
/// rounded to the nanosecond. A position that jumps across it crosses it at the break; a segment
/// that rests on it counts with both its ends. Equal means equal to rounding: 16·2⁻⁵² of the
/// largest terms. O(n·k³).
[[nodiscard]] std::vector<Time> crossings(const PiecewisePolynomial& curve, std::size_t dimension,
                                          double value);

/// The Euclidean length of the path, ∫|v| dt [unit], between two times, first break ≤ from ≤ to ≤
/// last break; jumps of the position add nothing. To about 1e-12 of its value: ten-point
/// Gauss–Legendre, halved where it does not agree with its halves, between the minima of the
/// speed, where |v| may have a kink. Bounded work.
[[nodiscard]] double arc_length(const PiecewisePolynomial& curve, Time from, Time to);

}  // namespace splinecast
