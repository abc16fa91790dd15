#pragma once

#include <optional>

#include "apps/tables/waypoints.hpp"
#include "core/online/sliding_window.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/method.hpp"
#include "splinecast/piecewise_polynomial.hpp"

namespace splinecast::apps {

/// What shapes a curve beside its method.
struct CurveOptions {
  std::optional<double> lambda{};  ///< of smoothing; unset: by cross-validation
  bool lambda_is_auto = false;     ///< asked for by name
  std::optional<double> time_scale{};
  std::optional<Condition> start{};
  std::optional<Condition> end{};
  bool online = false;
  std::optional<std::size_t> settle{};
  std::optional<Tail> tail{};
  bool force_lag = false;
};

/// Fits one method to a table, at once or as the solver would; a λ chosen by cross-validation is
/// said on stderr. Throws InputError naming the line of a waypoint that the method cannot take, and
/// std::invalid_argument for options that do not go with it.
[[nodiscard]] PiecewisePolynomial fit_table(const WaypointTable& table, const Method& method,
                                            const CurveOptions& options);

}  // namespace splinecast::apps
