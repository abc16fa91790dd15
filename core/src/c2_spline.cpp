#include "splinecast/core/c2_spline.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "splinecast/core/knot_ring.hpp"

namespace splinecast::core {
namespace {

void require_mesh(std::span<const Time> times, std::span<const double> positions,
                  std::size_t dimensions) {
  if (dimensions < kMinDimensions || dimensions > kMaxDimensions) {
    throw std::invalid_argument("dimensions must be 1 to 64, not " + std::to_string(dimensions));
  }
  if (times.empty()) throw std::invalid_argument("a spline needs at least one waypoint");
  if (positions.size() != times.size() * dimensions) {
    throw std::invalid_argument(std::to_string(positions.size()) + " position values for " +
                                std::to_string(times.size()) + " waypoints of " +
                                std::to_string(dimensions) + " dimensions");
  }
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] > times[i - 1]) continue;
    throw std::invalid_argument("time of waypoint " + std::to_string(i) + ", " +
                                std::to_string(times[i].count()) + " ns, is not after " +
                                std::to_string(times[i - 1].count()) + " ns");
  }
  const auto bad = std::ranges::find_if(positions, [](double x) { return !std::isfinite(x); });
  if (bad != positions.end()) {
    const auto at = static_cast<std::size_t>(bad - positions.begin());
    throw std::invalid_argument("position of waypoint " + std::to_string(at / dimensions) +
                                ", dimension " + std::to_string(at % dimensions) +
                                ", is not finite: " + std::to_string(*bad));
  }
}

}  // namespace

PiecewisePolynomial c2_spline(std::span<const Time> times, std::span<const double> positions,
                              std::size_t dimensions, const Condition& start,
                              const Condition& end) {
  require_mesh(times, positions, dimensions);
  require_values(start, dimensions);
  require_values(end, dimensions);

  KnotRing knots(dimensions, std::max<std::size_t>(times.size(), 2), start);
  for (std::size_t i = 0; i < times.size(); ++i) {
    knots.push(times[i], positions.subspan(i * dimensions, dimensions));
  }
  knots.close(end);
  knots.back_substitute_to(0);

  PiecewisePolynomial curve(dimensions);
  Segment segment(dimensions);
  if (times.size() == 1) {
    build_hold(times[0], positions, segment);
    curve.append(segment);
  }
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    build_segment(knots.interval(i), segment);
    write_acceleration_step(knots, i, false, segment.acceleration_step);
    curve.append(segment);
  }
  return curve;
}

}  // namespace splinecast::core
