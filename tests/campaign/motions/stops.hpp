#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/campaign/motions/sines.hpp"
#include "tests/campaign/motions/trial.hpp"

namespace splinecast::campaign {

/// Waypoints as a source gives them, appended live.
struct Data {
  std::string name;
  double rate = 0;     ///< Hz
  double quantum = 0;  ///< rad; 0: exact
};

/// A curve whose stops are measured.
struct Curve {
  std::string name;
  core::WindowOptions window{};
};

/// What the stop published at each millisecond is like, over all joints: it is what readers get if
/// no waypoint follows. And the segment before it, which ends at the newest waypoint.
struct StopMeasures {
  std::vector<double> velocity_errors;   ///< rad/s, at the newest knot; sorted
  std::vector<double> runs_on;           ///< rad beyond |v|T/2 of the true velocity; sorted
  std::vector<double> last_path_errors;  ///< rad, largest of each last segment; sorted
  double overshoot = 0;          ///< rad: last segment beyond the true motion's range within it
  double last_acceleration = 0;  ///< rad/s², largest of the last segments
  double stop_acceleration = 0;  ///< rad/s², largest of the stops
  double stop_jerk = 0;          ///< rad/s³
  std::uint64_t stops = 0;
  std::uint64_t not_monotone = 0;  ///< stops that speed up or turn round, of one joint
  std::uint64_t too_far = 0;       ///< stops further than |v|T/2 of their own velocity
  std::uint64_t in_entries = 0;    ///< milliseconds left out: no stop behind the spline
  double read_error = 0;           ///< rad, largest path error of a 1 kHz reader meanwhile
  double read_acceleration = 0;    ///< rad/s², largest that it reads
};

/// Runs the motion once, with a lead of 60 ms, and measures the stop of every millisecond from the
/// second second on.
[[nodiscard]] StopMeasures measure_stops(const Sines& motion, const Data& data, const Curve& curve);

/// Cuts the waypoints off at `cut` s, and returns how far, in rad, readers then come to rest from
/// where the stop published at that time ends. 0 is expected; 0 also if none
/// is published, because the curve is in an entry.
[[nodiscard]] double cut_off(const Sines& motion, const Data& data, const Curve& curve, double cut);

}  // namespace splinecast::campaign
