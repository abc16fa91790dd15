#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "splinecast/core/fit.hpp"
#include "splinecast/core/sliding_window.hpp"
#include "support/mesh.hpp"

namespace splinecast::testing {

/// The r-th derivative of a function of time, r = 0, 1, 2, in dimension d.
using Function = std::function<double(double t, std::size_t d, int r)>;

/// Waypoints for any method: a mesh with velocities and accelerations.
struct Trial {
  Mesh mesh;
  std::vector<double> velocities;
  std::vector<double> accelerations;

  [[nodiscard]] core::Waypoints waypoints() const;
};

/// A random mesh with random derivatives.
Trial random_trial(std::uint64_t seed, std::size_t knots, std::size_t dimensions, double ratio);

/// The values of a function at a mesh's times, in seconds from its first one.
Trial sampled_trial(const Mesh& mesh, const Function& f);

/// A mesh of `knots` times, `interval` apart, without positions.
Mesh regular_mesh(std::size_t knots, std::size_t dimensions, core::Time interval);

/// The options that ask a method for its best on a function: for `c2`, exact velocities at both
/// ends; for `smoothing`, next to no smoothing.
core::FitOptions exact_options(const core::Method& method, const Trial& trial);

/// The method's options, with a moderate λ for `smoothing`.
core::FitOptions plain_options(const core::Method& method);

/// The same for a window with the method's own settle lag, forced.
core::WindowOptions plain_window(const core::Method& method);

}  // namespace splinecast::testing
