#include "core/batch/c2.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/basics/number_text.hpp"
#include "core/batch/at_once.hpp"
#include "core/batch/knots.hpp"

namespace splinecast::core {
namespace {

[[noreturn]] void refuse(const std::string& condition, const std::string& reason) {
  throw std::invalid_argument("condition '" + condition + "' " + reason);
}

void require_closed(const Waypoints& waypoints) {
  const auto first = waypoints[0].position;
  const auto last = waypoints[waypoints.size() - 1].position;
  for (std::size_t d = 0; d < waypoints.dimensions; ++d) {
    // Equal except for the rounding of the input.
    const double rounding = 1e-12 * std::max(std::abs(first[d]), std::abs(last[d]));
    if (std::abs(last[d] - first[d]) <= rounding) continue;
    refuse("periodic", "needs a last position equal to the first one; dimension " +
                           std::to_string(d) + " goes from " + number_text(first[d]) + " to " +
                           number_text(last[d]));
  }
}

void require_pairing(const Waypoints& waypoints, const Condition& start, const Condition& end) {
  const bool start_joins = start.kind == ConditionKind::periodic;
  const bool end_joins = end.kind == ConditionKind::periodic;
  const std::string count = "; there are " + std::to_string(waypoints.size());
  if (start_joins != end_joins) {
    refuse("periodic",
           "needs the other end periodic too, not " + to_string(start_joins ? end : start));
  }
  if (start_joins) {
    if (waypoints.size() < 3) refuse("periodic", "needs 3 waypoints" + count);
    require_closed(waypoints);
  }
  const bool start_passes = start.kind == ConditionKind::not_a_knot;
  const bool end_passes = end.kind == ConditionKind::not_a_knot;
  if (start_passes && end_passes && waypoints.size() < 4) {
    refuse("not-a-knot", "at both ends needs 4 waypoints" + count);
  }
  if ((start_passes || end_passes) && waypoints.size() < 3) {
    refuse("not-a-knot", "needs 3 waypoints" + count);
  }
}

Condition velocity(std::vector<double> value) {
  return {.kind = ConditionKind::velocity, .value = std::move(value)};
}

/// The periodic spline. All velocities are linear in the velocity at the join: v = y + z·v_join,
/// where y is 0 and z is 1 at both ends. The row of the join then gives v_join.
KnotRing solve_periodic(const Waypoints& waypoints) {
  const std::size_t n = waypoints.size() - 1;
  const Condition rest{.kind = ConditionKind::clamped, .value = {}};
  const KnotRing y = solve_knots(waypoints, {}, rest, rest);
  const std::vector<double> zeros(waypoints.size());
  const KnotRing z = solve_knots({.dimensions = 1, .times = waypoints.times, .positions = zeros},
                                 {}, velocity({1.0}), velocity({1.0}));
  const auto v = [](const KnotRing& knots, std::size_t i) {
    return knots.values(i, KnotRing::kVelocity);
  };
  const double before = y.row(n - 1).h;
  const double after = y.row(0).h;
  const double pivot = 2 * (before + after) + after * v(z, n - 1)[0] + before * v(z, 1)[0];
  std::vector<double> join(waypoints.dimensions);
  for (std::size_t d = 0; d < join.size(); ++d) {
    const double right_side = 3 * (after * y.chord(n - 1)[d] + before * y.chord(0)[d]);
    join[d] = (right_side - after * v(y, n - 1)[d] - before * v(y, 1)[d]) / pivot;
  }
  return solve_knots(waypoints, {}, velocity(join), velocity(join));
}

}  // namespace

PiecewisePolynomial c2_spline(const Waypoints& waypoints, const Condition& start,
                              const Condition& end, C2Form form) {
  require_waypoints(waypoints);
  require_values(start, waypoints.dimensions);
  require_values(end, waypoints.dimensions);
  require_pairing(waypoints, start, end);
  if (waypoints.size() == 1) return hold_at(waypoints);
  if (form == C2Form::acceleration) return c2_by_accelerations(waypoints, start, end);
  if (start.kind == ConditionKind::periodic) return curve_of(solve_periodic(waypoints));
  return curve_of(solve_knots(waypoints, {}, start, end));
}

PiecewisePolynomial c2_spline(std::span<const Time> times, std::span<const double> positions,
                              std::size_t dimensions, const Condition& start,
                              const Condition& end) {
  return c2_spline({.dimensions = dimensions, .times = times, .positions = positions}, start, end);
}

PiecewisePolynomial fit_c2(const Waypoints& waypoints, const Condition& start,
                           const Condition& end) {
  return c2_spline(waypoints, start, end);
}

}  // namespace splinecast::core
