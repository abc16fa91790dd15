#include "apps/trials/joint_motion.hpp"

#include <cmath>
#include <numbers>

namespace splinecast::apps {
namespace {

double amplitude(std::size_t joint) { return 0.9 - 0.08 * static_cast<double>(joint); }
double frequency(std::size_t joint) { return 2.1 + 0.47 * static_cast<double>(joint); }  // rad/s

}  // namespace

std::vector<double> JointMotion::at(Time t, int derivative) const {
  std::vector<double> values(kJoints);
  const double s = to_seconds(t - start_);
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double w = frequency(j);
    values[j] = amplitude(j) * std::pow(w, derivative) *
                std::cos(w * s + derivative * std::numbers::pi / 2);
  }
  return values;
}

std::vector<double> JointMotion::peak_acceleration() {
  std::vector<double> values(kJoints);
  for (std::size_t j = 0; j < kJoints; ++j) values[j] = amplitude(j) * frequency(j) * frequency(j);
  return values;
}

}  // namespace splinecast::apps
