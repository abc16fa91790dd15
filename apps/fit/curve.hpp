#pragma once

#include <optional>

#include "apps/cli/conditions.hpp"
#include "apps/fit/rest.hpp"
#include "apps/recordings/gaps.hpp"
#include "apps/tables/waypoints.hpp"
#include "core/online/sliding_window.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/method.hpp"

namespace splinecast::apps {

/// Options of a curve, apart from its method.
struct CurveOptions {
  std::optional<double> lambda{};  ///< of smoothing; unset: by cross-validation
  bool lambda_is_auto = false;     ///< `--lambda auto` was given
  std::optional<double> scale{};   ///< of rounded, s
  std::optional<Condition> start{};
  std::optional<End> end{};
  RestRules rest{};  ///< of an end at rest
  bool online = false;
  std::optional<std::size_t> settle{};
  std::optional<Tail> tail{};
  bool force_lag = false;
  GapOptions gap{};
};

/// Fits one method to a table, in batch or online as the solver does. With GapPolicy::split the
/// curve halts at each gap, and an order-6 segment from rest to rest leads over it. Prints a λ
/// chosen by cross-validation on standard error. Throws InputError with the line of a waypoint that
/// the method does not accept, and std::invalid_argument for options that it does not support.
[[nodiscard]] FittedCurve fit_table(const WaypointTable& table, const Method& method,
                                    const CurveOptions& options);

}  // namespace splinecast::apps
