#pragma once

#include <concepts>
#include <cstddef>
#include <span>

#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

/// Whether each waypoint has all its values.
[[nodiscard]] inline bool is_complete(const Waypoints& columns) noexcept {
  const std::size_t values = columns.size() * columns.dimensions;
  const auto fits = [&](std::span<const double> given) {
    return given.empty() || given.size() == values;
  };
  return columns.positions.size() == values && fits(columns.velocities) &&
         fits(columns.accelerations);
}

/// The waypoints of a replacement: one after the other, or in columns. A view.
class ReplacementPath {
 public:
  ReplacementPath() = default;
  ReplacementPath(const Waypoint* waypoints, std::size_t size) noexcept
      : waypoints_(waypoints, size), size_(size) {}
  template <std::convertible_to<std::span<const Waypoint>> Range>
  ReplacementPath(const Range& waypoints) noexcept
      : waypoints_(waypoints), size_(waypoints_.size()) {}
  /// Of columns without the values of each waypoint, all positions are empty.
  ReplacementPath(const Waypoints& columns) noexcept
      : columns_(is_complete(columns) ? columns : Waypoints{.times = columns.times}),
        size_(columns.size()) {}

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] Waypoint operator[](std::size_t i) const noexcept {
    return waypoints_.empty() ? columns_[i] : waypoints_[i];
  }
  [[nodiscard]] Waypoint front() const noexcept { return (*this)[0]; }
  [[nodiscard]] Waypoint back() const noexcept { return (*this)[size_ - 1]; }

 private:
  std::span<const Waypoint> waypoints_;
  Waypoints columns_;
  std::size_t size_ = 0;
};

}  // namespace splinecast::ipc
