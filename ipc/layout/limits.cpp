#include "ipc/layout/limits.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

namespace splinecast::ipc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The values of a stream's dimensions; empty if all of them are `none`.
std::vector<double> values_or_none(const std::array<double, kMaxDimensions>& values,
                                   std::size_t dimensions, double none) {
  const auto of_stream = std::span(values).first(dimensions);
  if (std::ranges::all_of(of_stream, [none](double value) { return value == none; })) return {};
  return {of_stream.begin(), of_stream.end()};
}

/// Writes one value per dimension, or `none` for all.
void put_values(const std::vector<double>& values, std::size_t dimensions, double none,
                std::array<double, kMaxDimensions>& out) noexcept {
  for (std::size_t d = 0; d < dimensions; ++d) out[d] = values.empty() ? none : values[d];
}

}  // namespace

MotionLimits motion_limits(const RegionHeader& header) {
  RegionHeader bounds = header;
  for (std::size_t d = 0; d < header.dimensions; ++d) {
    if (header.lower_bound[d] != 0 || header.upper_bound[d] != 0) continue;
    bounds.lower_bound[d] = -kInfinity;
    bounds.upper_bound[d] = kInfinity;
  }
  return {.velocity = values_or_none(header.max_velocity, header.dimensions, 0),
          .acceleration = values_or_none(header.max_acceleration, header.dimensions, 0),
          .jerk = values_or_none(header.max_jerk, header.dimensions, 0),
          .lower = values_or_none(bounds.lower_bound, header.dimensions, -kInfinity),
          .upper = values_or_none(bounds.upper_bound, header.dimensions, kInfinity)};
}

Beyond beyond(const RegionHeader& header) noexcept { return static_cast<Beyond>(header.beyond); }

void put_limits(const MotionLimits& limits, RegionHeader& header) {
  require_limits(limits, dimensions_of(header));
  put_values(limits.velocity, header.dimensions, 0, header.max_velocity);
  put_values(limits.acceleration, header.dimensions, 0, header.max_acceleration);
  put_values(limits.jerk, header.dimensions, 0, header.max_jerk);
  put_values(limits.lower, header.dimensions, -kInfinity, header.lower_bound);
  put_values(limits.upper, header.dimensions, kInfinity, header.upper_bound);
  for (std::size_t d = 0; d < header.dimensions; ++d) {
    if (header.lower_bound[d] != -kInfinity || header.upper_bound[d] != kInfinity) continue;
    header.lower_bound[d] = 0;
    header.upper_bound[d] = 0;
  }
}

}  // namespace splinecast::ipc
