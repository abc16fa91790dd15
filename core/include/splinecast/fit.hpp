#pragma once

#include "splinecast/boundary_condition.hpp"
#include "splinecast/method.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/waypoint.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// What shapes a curve that is solved at once.
struct FitOptions {
  Interpolant interpolant{};
  Condition start{.kind = ConditionKind::own, .value = {}};  ///< `own`: see ConditionKind
  Condition end{.kind = ConditionKind::own, .value = {}};
};

/// The curve of a method through all waypoints at once (`smoothing`: near them).
///
/// There must be 1 to 64 dimensions and at least one waypoint; times must increase strictly and all
/// values be usable (is_usable). One waypoint gives a hold. `hermite` and `quintic` need
/// velocities, `quintic` accelerations too; the others do not look at them. Throws
/// std::invalid_argument, with the reason, index and value, for anything else. O(n·D).
///
/// Conditions that a method takes at its ends:
///
/// - `c2`: all. `not_a_knot` needs three waypoints, at both ends four; `periodic` needs three, of
///   which the last has the position of the first, to within rounding.
/// - `normalized`: `natural` and `own`.
/// - the others: those for which is_online() holds. For `hermite` and `quintic` the condition
///   replaces what the waypoint gives there; for `smoothing` it moves no knot.
[[nodiscard]] PiecewisePolynomial fit(const Waypoints& waypoints, const FitOptions& options);

/// The λ that generalised cross-validation chooses for `smoothing`, one for all dimensions: the
/// minimum of n·Σ(x_i − f(t_i))²/(n − tr H)² over λ, squares summed over dimensions, H being the
/// matrix that takes x to f(t_i). The trace is exact, from the band of the inverse (Hutchinson and
/// de Hoog). Sought from what smooths nothing to what leaves but a line; 0 for fewer than three
/// waypoints. O(n·D), about sixty times. Throws as `fit` does.
[[nodiscard]] double cross_validated_lambda(const Waypoints& waypoints);

/// The mean squared error, in the sense of generalised cross-validation, that smoothing with λ > 0
/// leaves: what cross_validated_lambda minimises. At least three waypoints. O(n·D).
[[nodiscard]] double cross_validation_score(const Waypoints& waypoints, double lambda);

}  // namespace splinecast
