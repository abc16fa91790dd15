#include "splinecast/fit.hpp"

#include <stdexcept>
#include <string>

#include "core/batch/knots.hpp"
#include "core/solvers/families.hpp"

namespace splinecast {
namespace {

void require_given(const Waypoints& waypoints, const Method& method) {
  const auto require = [&](bool needed, std::span<const double> values, const char* what) {
    if (!needed) return;
    if (values.empty()) {
      throw std::invalid_argument("method " + std::string(method.name) + " needs a " + what +
                                  " with every waypoint");
    }
    core::require_values_of(waypoints, values, what);
  };
  require(method.needs_velocity(), waypoints.velocities, "velocity");
  require(method.needs_acceleration(), waypoints.accelerations, "acceleration");
}

void require_condition(const Condition& condition, const Method& method, std::size_t dimensions) {
  require_values(condition, dimensions);
  if (!is_online(condition.kind)) {
    throw std::invalid_argument("condition '" + to_string(condition) + "' is for c2, not for " +
                                std::string(method.name));
  }
}

}  // namespace

PiecewisePolynomial fit(const Waypoints& waypoints, const FitOptions& options) {
  const Method& method = *options.interpolant.method;
  const core::FitAtOnce fit_at_once = core::procedure_of(method).fit_at_once;
  if (fit_at_once != nullptr) return fit_at_once(waypoints, options.start, options.end);
  core::require_waypoints(waypoints);
  require_given(waypoints, method);
  require_parameters(options.interpolant);
  require_condition(options.start, method, waypoints.dimensions);
  require_condition(options.end, method, waypoints.dimensions);
  if (waypoints.size() == 1) return core::hold_at(waypoints);
  return core::curve_of(
      core::solve_knots(waypoints, options.interpolant, options.start, options.end));
}

}  // namespace splinecast
