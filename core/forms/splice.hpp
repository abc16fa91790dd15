#pragma once

#include <span>

#include "core/polynomial/segment.hpp"
#include "splinecast/time.hpp"

/// Splices: the order-6 segments by which a curve goes on from a given state. Every function is
/// O(D), allocates nothing and throws nothing.
namespace splinecast::core {

/// A state at an instant. Spans hold one value per dimension; does not own them.
struct Instant {
  Time time{};
  std::span<const double> position;
  std::span<const double> velocity;
  std::span<const double> acceleration;
};

/// Writes the quintic from one state to a later one. Sets everything but `acceleration_step`.
void build_splice(const Instant& from, const Instant& to, Segment& out) noexcept;

}  // namespace splinecast::core
