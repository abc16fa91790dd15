#include <stdexcept>
#include <string>
#include <vector>

#include "core/batch/at_once.hpp"
#include "core/batch/c2.hpp"
#include "core/batch/knots.hpp"
#include "core/polynomial/segment.hpp"

namespace splinecast::core {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

void require_natural(const Condition& condition, std::size_t dimensions) {
  require_values(condition, dimensions);
  const bool is_natural =
      condition.kind == ConditionKind::natural || condition.kind == ConditionKind::own;
  if (!is_online(condition.kind)) {
    throw std::invalid_argument("condition '" + to_string(condition) +
                                "' is for c2, not for normalized");
  }
  if (!is_natural) {
    throw std::invalid_argument("normalized ends naturally, not with '" + to_string(condition) +
                                "'");
  }
}

/// Solves the 1-4-1 system in accelerations.
PiecewisePolynomial stretched(const Waypoints& waypoints) {
  std::vector<Time> unit_times;
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    unit_times.emplace_back(static_cast<std::int64_t>(i) * kNanosecondsPerSecond);
  }
  const std::size_t dimensions = waypoints.dimensions;
  const auto unit =
      c2_spline({.dimensions = dimensions, .times = unit_times, .positions = waypoints.positions},
                {}, {}, C2Form::acceleration);
  PiecewisePolynomial curve(dimensions);
  Segment segment(dimensions);
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
    append(segment, curve);
  }
  return curve;
}

}  // namespace

PiecewisePolynomial fit_normalized(const Waypoints& waypoints, const Condition& start,
                                   const Condition& end) {
  require_waypoints(waypoints);
  require_natural(start, waypoints.dimensions);
  require_natural(end, waypoints.dimensions);
  return waypoints.size() == 1 ? hold_at(waypoints) : stretched(waypoints);
}

}  // namespace splinecast::core
