#pragma once

#include "splinecast/piecewise_polynomial.hpp"

/// Curves made from curves. Each function returns a new curve in O(n·k·D) and allocates it; a hold
/// is a curve like any other. All throw std::invalid_argument with the offending values.
namespace splinecast::core {

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

}  // namespace splinecast::core
