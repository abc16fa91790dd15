#pragma once

#include <cstdint>
#include <vector>

#include "splinecast/core/piecewise_polynomial.hpp"
#include "support/mesh.hpp"

namespace splinecast::testing {

/// The C² spline through a mesh; `halts` at both ends gives it segments of order 6, else natural.
core::PiecewisePolynomial batch_curve(const Mesh& mesh, bool halts);

/// What the sliding window makes of a mesh: with a short lag the accelerations step at its knots.
core::PiecewisePolynomial online_curve(const Mesh& mesh, std::size_t settle, bool halts);

/// Segments of random orders 1 to 8 with random coefficients, which nothing joins.
core::PiecewisePolynomial patchwork(std::uint64_t seed, std::size_t segments,
                                    std::size_t dimensions);

/// A curve of one of these kinds and of up to `ratio` between neighbouring intervals.
core::PiecewisePolynomial random_curve(std::uint64_t seed, std::size_t dimensions, double ratio);

/// Times spread over a curve, its breaks among them.
std::vector<core::Time> times_of(const core::PiecewisePolynomial& curve, std::int64_t per_segment);

/// Largest value of the r-th derivative at such times.
double largest(const core::PiecewisePolynomial& curve, int r);

/// Largest difference between the r-th derivatives of two curves at times of the first.
double largest_difference(const core::PiecewisePolynomial& a, const core::PiecewisePolynomial& b,
                          int r);

/// What a conversion to control points and back may cost the r-th derivative, of its largest value.
/// Control points are positions: their rounding is divided by h^r of the shortest interval, which
/// at large ratios is more than 1e-12 of the accelerations and jerks (of 20,000 curves 7e-12 at
/// most).
double relative_bound(double ratio, int r);

}  // namespace splinecast::testing
