#include "support/online.hpp"

namespace splinecast::testing {

std::vector<core::Segment> settled_segments(const core::Waypoints& waypoints,
                                            const core::WindowOptions& how,
                                            const core::Condition& end) {
  core::SlidingWindow window(waypoints.dimensions, how);
  std::vector<core::Segment> settled;
  core::Segment segment(waypoints.dimensions);
  const auto take = [&] {
    while (settled.size() < window.settled_segments()) {
      window.segment(settled.size(), segment);
      settled.push_back(segment);
    }
  };
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    window.append(waypoints[i]);
    take();
  }
  window.finish(end);
  take();
  return settled;
}

core::PiecewisePolynomial online(const core::Waypoints& waypoints, const core::WindowOptions& how,
                                 const core::Condition& end) {
  core::PiecewisePolynomial curve(waypoints.dimensions);
  for (const core::Segment& segment : settled_segments(waypoints, how, end)) curve.append(segment);
  return curve;
}

}  // namespace splinecast::testing
