#include "support/mesh.hpp"

#include <algorithm>
#include <cmath>

namespace splinecast::testing {

Mesh Mesh::first(std::size_t count) const {
  const auto length = static_cast<std::ptrdiff_t>(count);
  const auto values = static_cast<std::ptrdiff_t>(count * dimensions);
  return {dimensions,
          {times.begin(), times.begin() + length},
          {positions.begin(), positions.begin() + values}};
}

Mesh random_mesh(std::uint64_t seed, std::size_t knots, std::size_t dimensions, double ratio) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> factor(-std::log(ratio), std::log(ratio));
  std::normal_distribution<double> step(0, 0.1);
  Mesh mesh{.dimensions = dimensions, .times = {}, .positions = {}};
  std::vector<double> position(dimensions);
  double interval = 1e7;
  double time = 0;
  for (std::size_t i = 0; i < knots; ++i) {
    mesh.times.emplace_back(std::llround(time));
    for (double& x : position) x += step(random);
    mesh.positions.insert(mesh.positions.end(), position.begin(), position.end());
    interval = std::clamp(interval * std::exp(factor(random)), 1e5, 1e9);
    time += interval;
  }
  return mesh;
}

std::vector<double> random_values(std::uint64_t seed, std::size_t count) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> value(-1, 1);
  std::vector<double> values(count);
  for (double& x : values) x = value(random);
  return values;
}

std::vector<core::Time> query_times(const Mesh& mesh, std::size_t per_interval) {
  std::vector<core::Time> times;
  for (std::size_t i = 0; i + 1 < mesh.size(); ++i) {
    const auto h = mesh.times[i + 1] - mesh.times[i];
    for (std::size_t k = 0; k < per_interval; ++k) {
      times.push_back(mesh.times[i] + h * static_cast<int>(k) / static_cast<int>(per_interval));
    }
  }
  times.push_back(mesh.times.back());
  return times;
}

}  // namespace splinecast::testing
