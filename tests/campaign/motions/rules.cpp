#include "tests/campaign/motions/rules.hpp"

#include <algorithm>

#include "core/online/sliding_window.hpp"

namespace splinecast::campaign {

double most_without_limits(const Peaks& motion, double largest_error) {
  constexpr double kSlack = 1.1;
  constexpr double kFar = 0.5;  // rad: above it the target moves far during the return
  const double stop = to_seconds(core::WindowOptions{}.stop_length);
  const double way = largest_error > kFar ? largest_error + motion.velocity : 0;
  return kSlack * std::max({3 * motion.acceleration, 1.5 * motion.velocity / stop, 6 * way});
}

}  // namespace splinecast::campaign
