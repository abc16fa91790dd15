#include "core/batch/knots.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "core/basics/number_text.hpp"
#include "core/solvers/knot_solver.hpp"
#include "splinecast/state.hpp"

namespace splinecast::core {

void require_values_of(const Waypoints& waypoints, std::span<const double> values,
                       const char* what) {
  const std::size_t dimensions = waypoints.dimensions;
  if (values.size() != waypoints.size() * dimensions) {
    throw std::invalid_argument(std::to_string(values.size()) + ' ' + what + " values for " +
                                std::to_string(waypoints.size()) + " waypoints of " +
                                std::to_string(dimensions) + " dimensions");
  }
  const auto bad = std::ranges::find_if_not(values, is_usable);
  if (bad == values.end()) return;
  const auto at = static_cast<std::size_t>(bad - values.begin());
  throw std::invalid_argument(
      std::string(what) + " of waypoint " + std::to_string(at / dimensions) + ", dimension " +
      std::to_string(at % dimensions) + ", is not finite, or beyond 1e100: " + number_text(*bad));
}

void require_waypoints(const Waypoints& waypoints) {
  const std::size_t dimensions = waypoints.dimensions;
  const auto times = waypoints.times;
  if (dimensions < kMinDimensions || dimensions > kMaxDimensions) {
    throw std::invalid_argument("dimensions must be 1 to 64, not " + std::to_string(dimensions));
  }
  if (times.empty()) throw std::invalid_argument("a spline needs at least one waypoint");
  require_values_of(waypoints, waypoints.positions, "position");
  for (const std::size_t i : {std::size_t{0}, times.size() - 1}) {
    if (is_time_in_range(times[i])) continue;
    throw std::invalid_argument("time of waypoint " + std::to_string(i) + ", " +
                                std::to_string(times[i].count()) +
                                " ns, is outside of ±(2^62 - 1) ns");
  }
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] > times[i - 1]) continue;
    throw std::invalid_argument("time of waypoint " + std::to_string(i) + ", " +
                                std::to_string(times[i].count()) + " ns, is not after " +
                                std::to_string(times[i - 1].count()) + " ns");
  }
}

KnotRing measure_knots(const Waypoints& waypoints, bool halts_at_start) {
  KnotRing knots(waypoints.dimensions, std::max<std::size_t>(waypoints.size(), 3), c2(),
                 halts_at_start);
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    knots.push(waypoints.times[i], waypoints[i].position);
  }
  return knots;
}

KnotRing solve_knots(const Waypoints& waypoints, const Interpolant& how, const Condition& start,
                     const Condition& end) {
  KnotRing knots(waypoints.dimensions, std::max<std::size_t>(waypoints.size(), 3), *how.method,
                 start.kind == ConditionKind::halt);
  const auto solver = make_knot_solver(how, start, waypoints.dimensions, Use::at_once);
  for (std::size_t i = 0; i < waypoints.size(); ++i) solver->push(knots, waypoints[i]);
  solver->solve(knots, end, 0);
  return knots;
}

PiecewisePolynomial hold_at(const Waypoints& waypoints) {
  PiecewisePolynomial curve(waypoints.dimensions);
  Segment segment(waypoints.dimensions);
  build_hold(waypoints.times[0], waypoints.times[0], waypoints[0].position, segment);
  append(segment, curve);
  return curve;
}

PiecewisePolynomial curve_of(const KnotRing& knots) {
  PiecewisePolynomial curve(knots.dimensions());
  Segment segment(knots.dimensions());
  for (std::size_t i = 0; i < knots.newest(); ++i) {
    const Interval interval = knots.interval(i);
    build_segment(interval, segment);
    write_acceleration_step(knots, i, interval, false, segment.acceleration_step);
    append(segment, curve);
  }
  return curve;
}

}  // namespace splinecast::core
