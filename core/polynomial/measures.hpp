#pragma once

#include <cstddef>
#include <vector>

#include "splinecast/piecewise_polynomial.hpp"

/// What can be measured on a curve. All throw std::invalid_argument, with the value, for an empty
/// curve and for a dimension, derivative or time out of range.
namespace splinecast::core {

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

}  // namespace splinecast::core
