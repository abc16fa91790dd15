#pragma once

#include <cstddef>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// An endless motion of seven joint angles in rad, each a cosine with its own frequency, which
/// starts at rest.
class JointMotion {
 public:
  static constexpr std::size_t kJoints = 7;
  explicit JointMotion(Time start) : start_(start) {}

  /// The derivative-th derivative (0 to 2) of every joint at t.
  [[nodiscard]] std::vector<double> at(Time t, int derivative = 0) const;

  /// The largest acceleration of every joint, rad/s².
  [[nodiscard]] static std::vector<double> peak_acceleration();

 private:
  Time start_;
};

}  // namespace splinecast::apps
