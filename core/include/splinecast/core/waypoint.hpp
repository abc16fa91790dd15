#pragma once

#include <span>

#include "splinecast/core/time.hpp"

namespace splinecast::core {

/// What a producer gives: a time, a position and, optionally, velocity and acceleration.
/// Spans hold one value per dimension; an empty span says "not given". Does not own its values.
struct Waypoint {
  Time time{};
  std::span<const double> position{};
  std::span<const double> velocity{};
  std::span<const double> acceleration{};
};

}  // namespace splinecast::core
