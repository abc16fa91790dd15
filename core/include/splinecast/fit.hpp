#pragma once

#include "splinecast/boundary_condition.hpp"
#include "splinecast/method.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/waypoint.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// Options of a batch fit.
struct FitOptions {
  Interpolant interpolant{};
  Condition start{.kind = ConditionKind::own, .value = {}};  ///< `own`: see ConditionKind
  Condition end{.kind = ConditionKind::own, .value = {}};
};

/// Fits a curve through all waypoints at once (`smoothing`: near them).
///
/// Requires 1 to 64 dimensions, at least one waypoint, strictly increasing times in range
/// (is_time_in_range) and usable values (is_usable). One waypoint gives a hold. `hermite` and
/// `quintic` need velocities, `quintic` also accelerations; the other methods ignore them. Throws
/// std::invalid_argument, with the reason, index and value, otherwise. O(n·D).
///
/// Boundary conditions that a method accepts:
///
/// - `c2`: all. `not_a_knot` needs three waypoints, four if it is at both ends; `periodic` needs
///   three, and a last position equal to the first, to within rounding.
/// - `normalized`: `natural` and `own`.
/// - the others: those for which is_online() holds. For `hermite` and `quintic` the condition
///   replaces the values given with the waypoint; for `smoothing` it does not move a knot.
[[nodiscard]] PiecewisePolynomial fit(const Waypoints& waypoints, const FitOptions& options);

/// The λ that generalised cross-validation chooses for `smoothing`, one for all dimensions: the
/// minimum of n·Σ(x_i − f(t_i))²/(n − tr H)² over λ, with squares summed over dimensions and the
/// matrix H that maps x to f(t_i). The trace is exact, from the band of the inverse (Hutchinson and
/// de Hoog). The search ranges from no smoothing to a straight line. Returns 0 for fewer than three
/// waypoints. Costs about sixty solves of O(n·D). Throws as `fit` does.
[[nodiscard]] double cross_validated_lambda(const Waypoints& waypoints);

/// The score that cross_validated_lambda minimises, for a λ > 0: an estimate of the mean squared
/// error by generalised cross-validation. Needs at least three waypoints. O(n·D).
[[nodiscard]] double cross_validation_score(const Waypoints& waypoints, double lambda);

}  // namespace splinecast
