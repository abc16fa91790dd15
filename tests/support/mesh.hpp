#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "splinecast/core/time.hpp"

namespace splinecast::testing {

/// Random waypoints: strictly increasing times and positions [knot][dimension].
struct Mesh {
  std::size_t dimensions = 0;
  std::vector<core::Time> times;
  std::vector<double> positions;

  [[nodiscard]] std::size_t size() const { return times.size(); }
  [[nodiscard]] std::span<const double> position(std::size_t i) const {
    return std::span(positions).subspan(i * dimensions, dimensions);
  }
  [[nodiscard]] Mesh first(std::size_t count) const;
};

/// A random walk whose neighbouring intervals differ by a factor of up to `ratio`, around 10 ms.
Mesh random_mesh(std::uint64_t seed, std::size_t knots, std::size_t dimensions, double ratio);

/// `count` random values between −1 and 1.
std::vector<double> random_values(std::uint64_t seed, std::size_t count);

/// Instants spread over the mesh, its knots among them.
std::vector<core::Time> query_times(const Mesh& mesh, std::size_t per_interval);

}  // namespace splinecast::testing
