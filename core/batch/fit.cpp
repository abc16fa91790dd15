#include "splinecast/fit.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include "core/batch/c2.hpp"
#include "core/batch/knots.hpp"

namespace splinecast {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

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
  const bool is_natural =
      condition.kind == ConditionKind::natural || condition.kind == ConditionKind::own;
  if (!is_online(condition.kind)) {
    throw std::invalid_argument("condition '" + to_string(condition) + "' is for c2, not for " +
                                std::string(method.name));
  }
  if (method.family == Family::unit && !is_natural) {
    throw std::invalid_argument(std::string(method.name) + " ends naturally, not with '" +
                                to_string(condition) + "'");
  }
}

/// doc 002: the C² spline in a parameter that grows by 1 from waypoint to waypoint (the 1-4-1
/// system in accelerations), each segment then stretched over its real interval.
PiecewisePolynomial normalized(const Waypoints& waypoints) {
  std::vector<Time> unit_times;
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    unit_times.emplace_back(static_cast<std::int64_t>(i) * kNanosecondsPerSecond);
  }
  const std::size_t dimensions = waypoints.dimensions;
  const auto unit = core::c2_spline(
      {.dimensions = dimensions, .times = unit_times, .positions = waypoints.positions}, {}, {},
      core::C2Form::acceleration);
  PiecewisePolynomial curve(dimensions);
  core::Segment segment(dimensions);
  for (std::size_t i = 0; i < unit.segments(); ++i) {
    segment.left = waypoints.times[i];
    segment.right = waypoints.times[i + 1];
    const double h = to_seconds(segment.right - segment.left);
    double stretch = 1;
    for (std::size_t k = 0; k < kCubicOrder; ++k) {
      for (std::size_t d = 0; d < dimensions; ++d) {
        const std::size_t at = k * dimensions + d;
        segment.coefficients[at] = unit.coefficients(i)[at] / stretch;
      }
      stretch *= h;
    }
    core::append(segment, curve);
  }
  return curve;
}

}  // namespace

PiecewisePolynomial fit(const Waypoints& waypoints, const FitOptions& options) {
  const Method& method = *options.interpolant.method;
  if (method.family == Family::tridiagonal) {
    return core::c2_spline(waypoints, options.start, options.end);
  }
  core::require_waypoints(waypoints);
  require_given(waypoints, method);
  require_parameters(options.interpolant);
  require_condition(options.start, method, waypoints.dimensions);
  require_condition(options.end, method, waypoints.dimensions);
  if (waypoints.size() == 1) return core::hold_at(waypoints);
  if (method.family == Family::unit) return normalized(waypoints);
  return core::curve_of(
      core::solve_knots(waypoints, options.interpolant, options.start, options.end));
}

}  // namespace splinecast
