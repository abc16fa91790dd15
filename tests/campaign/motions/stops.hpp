#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/campaign/motions/sines.hpp"
#include "tests/campaign/motions/trial.hpp"

namespace splinecast::campaign {

/// A source of live waypoints.
struct Data {
  std::string name;
  double rate = 0;     ///< Hz
  double quantum = 0;  ///< rad; 0: exact
};

/// A type of curve whose stops are measured.
struct Curve {
  std::string name;
  core::WindowOptions window{};
};

/// Measures of the stop segments published at each millisecond, over all joints. Readers get such a
/// stop if no waypoint follows. The "last segment" is the one before it, which ends at the newest
/// waypoint.
struct StopMeasures {
  std::vector<double> velocity_errors;   ///< rad/s, at the newest knot; sorted
  std::vector<double> runs_on;           ///< rad beyond |v|T/2, v being the true velocity; sorted
  std::vector<double> last_path_errors;  ///< rad, largest of each last segment; sorted
  double overshoot = 0;          ///< rad of a last segment beyond the true motion's range there
  double last_acceleration = 0;  ///< rad/s², largest of the last segments
  double stop_acceleration = 0;  ///< rad/s², largest of the stops
  double stop_jerk = 0;          ///< rad/s³, largest of the stops
  std::uint64_t stops = 0;
  std::uint64_t not_monotone = 0;  ///< stops of a joint that speed up or reverse
  std::uint64_t too_far = 0;       ///< stops of a joint longer than |v|T/2, v as the stop begins
  std::uint64_t in_entries = 0;    ///< milliseconds not measured: no stop after the spline
  double read_error = 0;           ///< rad, largest path error of a 1 kHz reader
  double read_acceleration = 0;    ///< rad/s², largest acceleration of a 1 kHz reader
};

/// Runs the motion once, with a lead of 60 ms, and measures the published stop at each millisecond
/// from 2 s on.
[[nodiscard]] StopMeasures measure_stops(const Sines& motion, const Data& data, const Curve& curve);

/// Ends the waypoints at `cut` s. Returns the distance in rad between the position at which readers
/// come to rest and the end of the stop published at `cut`. 0 is expected; also 0 if no stop is
/// published because the curve is in an entry.
[[nodiscard]] double cut_off(const Sines& motion, const Data& data, const Curve& curve, double cut);

}  // namespace splinecast::campaign
