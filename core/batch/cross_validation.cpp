#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "core/batch/knots.hpp"
#include "core/solvers/smoothing_mesh.hpp"
#include "splinecast/fit.hpp"

namespace splinecast {
namespace {

/// Σ(x_i − f(t_i))² over all dimensions.
double squared_residuals(const core::BatchSmoothing& system, std::size_t dimensions) {
  double sum = 0;
  for (std::size_t d = 0; d < dimensions; ++d) {
    for (const core::DoubleDouble residual : system.solve(d).residual) {
      sum += static_cast<double>(residual) * static_cast<double>(residual);
    }
  }
  return sum;
}

double score_of(const core::SmoothingMesh& mesh, double lambda) {
  const core::KnotRing& knots = mesh.knots();
  const core::BatchSmoothing system(mesh, lambda);
  const double trace = system.residual_trace();
  return static_cast<double>(knots.size()) * squared_residuals(system, knots.dimensions()) /
         (trace * trace);
}

/// The minimum of a function between two points, by golden-section search.
template <typename Function>
double minimum_between(double low, double high, const Function& f) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr double kEnough = 1e-4;
  constexpr int kMostRounds = 200;  // each keeps 0.62 of the bracket: enough for any doubles
  double left = high - kGolden * (high - low);
  double right = low + kGolden * (high - low);
  double at_left = f(left);
  double at_right = f(right);
  for (int round = 0; round < kMostRounds && high - low > kEnough; ++round) {
    if (at_left <= at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = f(left);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = f(right);
    }
  }
  return (low + high) / 2;
}

}  // namespace

double cross_validation_score(const Waypoints& waypoints, double lambda) {
  core::require_waypoints(waypoints);
  if (waypoints.size() < 3) {
    throw std::invalid_argument("cross-validation needs 3 waypoints; there are " +
                                std::to_string(waypoints.size()));
  }
  require_parameters({.method = find_method("smoothing"), .lambda = lambda});
  const core::KnotRing knots = core::measure_knots(waypoints, false);
  return score_of(core::SmoothingMesh(knots), lambda);
}

double cross_validated_lambda(const Waypoints& waypoints) {
  core::require_waypoints(waypoints);
  if (waypoints.size() < 3) return 0;
  const core::KnotRing knots = core::measure_knots(waypoints, false);
  const core::SmoothingMesh mesh(knots);
  double shortest = knots.row(0).h;
  for (std::size_t i = 1; i < knots.newest(); ++i) shortest = std::min(shortest, knots.row(i).h);
  // Searches from no smoothing (λ/h³ ≪ 1) to a straight line (λ·(seconds per knot)/duration⁴ ≫ 1).
  const double duration = to_seconds(waypoints.times.back() - waypoints.times.front());
  const double mean = duration / static_cast<double>(knots.newest());
  constexpr double kMargin = 1e6;
  const double lowest = std::log(shortest * shortest * shortest / kMargin);
  const double highest = std::log(kMargin * std::pow(duration, 4) / mean);
  constexpr int kSteps = 40;
  const double step = (highest - lowest) / kSteps;
  const auto score = [&](double log_lambda) { return score_of(mesh, std::exp(log_lambda)); };
  int best = 0;
  double least = score(lowest);
  for (int i = 1; i <= kSteps; ++i) {
    const double found = score(lowest + i * step);
    if (found < least) {
      least = found;
      best = i;
    }
  }
  const double middle = lowest + best * step;
  return std::exp(
      minimum_between(std::max(lowest, middle - step), std::min(highest, middle + step), score));
}

}  // namespace splinecast
