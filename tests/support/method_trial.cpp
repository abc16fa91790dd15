#include "support/method_trial.hpp"

namespace splinecast::testing {

using core::ConditionKind;
using core::Family;

core::Waypoints Trial::waypoints() const {
  return {.dimensions = mesh.dimensions,
          .times = mesh.times,
          .positions = mesh.positions,
          .velocities = velocities,
          .accelerations = accelerations};
}

Trial random_trial(std::uint64_t seed, std::size_t knots, std::size_t dimensions, double ratio) {
  Trial trial{random_mesh(seed, knots, dimensions, ratio), {}, {}};
  trial.velocities = random_values(seed + 1, knots * dimensions);
  trial.accelerations = random_values(seed + 2, knots * dimensions);
  return trial;
}

Trial sampled_trial(const Mesh& mesh, const Function& f) {
  Trial trial{mesh, {}, {}};
  trial.mesh.positions.clear();
  for (const core::Time time : mesh.times) {
    const double t = core::to_seconds(time - mesh.times.front());
    for (std::size_t d = 0; d < mesh.dimensions; ++d) {
      trial.mesh.positions.push_back(f(t, d, 0));
      trial.velocities.push_back(f(t, d, 1));
      trial.accelerations.push_back(f(t, d, 2));
    }
  }
  return trial;
}

Mesh regular_mesh(std::size_t knots, std::size_t dimensions, core::Time interval) {
  Mesh mesh{.dimensions = dimensions, .times = {}, .positions = {}};
  for (std::size_t i = 0; i < knots; ++i) mesh.times.push_back(interval * static_cast<int>(i));
  return mesh;
}

core::FitOptions exact_options(const core::Method& method, const Trial& trial) {
  core::FitOptions options;
  options.interpolant.method = &method;
  if (method.family == Family::tridiagonal) {
    const core::Waypoints all = trial.waypoints();
    const auto velocity = [&](std::size_t i) {
      const auto v = all[i].velocity;
      return core::Condition{ConditionKind::velocity, {v.begin(), v.end()}};
    };
    options.start = velocity(0);
    options.end = velocity(all.size() - 1);
  }
  if (method.family == Family::smoothing) options.interpolant.lambda = 1e-18;
  return options;
}

core::FitOptions plain_options(const core::Method& method) {
  core::FitOptions options;
  options.interpolant.method = &method;
  if (method.family == Family::smoothing) options.interpolant.lambda = 1e-6;
  return options;
}

core::WindowOptions plain_window(const core::Method& method) {
  return {.interpolant = plain_options(method).interpolant,
          .settle = core::default_settle(method),
          .force_lag = true};
}

}  // namespace splinecast::testing
