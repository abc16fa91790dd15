#include "tests/campaign/motions/ended.hpp"

#include <algorithm>
#include <array>

namespace splinecast::campaign {
namespace {

constexpr double kEase = 1;  ///< s

constexpr std::array kEnds{
    Ended{.name = "finish of a motion that comes to rest", .file = "ends/requested", .eases = true},
    Ended{.name = "finish in motion, lead 400 ms", .file = "ends/slowed"},
    Ended{.name = "finish in motion, 5 Hz, lead 600 ms",
          .file = "ends/entered",
          .rate = 5,
          .lead = 0.6},
    Ended{.name = "finish in motion, lead 30 ms", .file = "ends/stopped", .lead = 0.03},
    Ended{.name = "finish 40 ms after the stop has begun",
          .file = "ends/returned",
          .lead = 0.06,
          .finish = 0.1},
    Ended{.name = "the same, with the last waypoint beyond a bound",
          .file = "ends/in_stop",
          .lead = 0.06,
          .finish = 0.1,
          .wall = 0.002},
};

}  // namespace

double EndedMotion::at(std::size_t joint, double t, int derivative) const {
  if (t > kEnd) return derivative == 0 ? at(joint, kEnd) : 0;
  const double u = (t - (kEnd - kEase)) / kEase;
  if (!eases_ || u <= 0) return motion_.at(joint, t, derivative);
  const double way = kEnd - kEase + kEase * (u - u * u * u + u * u * u * u / 2);
  const double rate = 1 - 3 * u * u + 2 * u * u * u;
  return motion_.at(joint, way, derivative) * (derivative == 0 ? 1 : rate);
}

Schedule Ended::schedule(const EndedMotion& motion) const {
  Schedule schedule = steady(motion, rate, lead);
  std::erase_if(schedule.calls,
                [](const Call& call) { return call.times[0] > EndedMotion::kEnd + 1e-9; });
  schedule.finish_at = EndedMotion::kEnd - lead + finish;
  return schedule;
}

MotionLimits Ended::limits(const EndedMotion& motion, double acceleration) const {
  MotionLimits limits;
  if (acceleration > 0) limits.acceleration.assign(motion.joints(), acceleration);
  if (wall == 0) return limits;
  // Only the first joint has a bound, on the side to which it moves.
  constexpr double kFar = 100;
  limits.lower.assign(motion.joints(), -kFar);
  limits.upper.assign(motion.joints(), kFar);
  const double last = motion.at(0, EndedMotion::kEnd);
  const bool rises = motion.at(0, EndedMotion::kEnd, 1) > 0;
  (rises ? limits.upper : limits.lower)[0] = last + (rises ? -wall : wall);
  return limits;
}

std::span<const Ended> ends() { return kEnds; }

}  // namespace splinecast::campaign
