#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "batch.hpp"
#include "splinecast/core/fit.hpp"

namespace splinecast::core {
namespace {

/// A row of A⁻¹, from its diagonal to the right, as far as the band of A goes.
struct InverseBand {
  double diagonal = 0;
  double next = 0;
  double second = 0;
};

/// tr(I − H) = λ tr(A⁻¹QᵀQ) with A = R + λQᵀQ: only the band of A⁻¹ counts, and that follows from
/// LDLᵀ by a recursion from the right (Hutchinson and de Hoog 1985).
double residual_trace(const KnotRing& knots, double lambda) {
  const std::size_t n = knots.newest();
  const auto row = [&](std::size_t j) {
    return j < n ? knots.row(j).prefix.smoothing : SmoothingRow{};
  };
  const auto h = [&](std::size_t i) { return knots.row(i).h; };
  InverseBand after;
  InverseBand after2;
  double trace = 0;
  for (std::size_t j = n - 1; j >= 1; --j) {
    const double l1 = row(j + 1).lower1;
    const double l2 = row(j + 2).lower2;
    InverseBand band;
    band.second = -l1 * after.next - l2 * after2.diagonal;
    band.next = -l1 * after.diagonal - l2 * after.next;
    band.diagonal = 1 / row(j).pivot - l1 * band.next - l2 * band.second;
    trace += band.diagonal * roughness_diagonal(h(j - 1), h(j));
    if (j + 1 < n) {
      trace += 2 * band.next *
               roughness_neighbour({.h_before2 = h(j - 1), .h_before = h(j), .h_after = h(j + 1)});
    }
    if (j + 2 < n) {
      trace += 2 * band.second *
               roughness_second_neighbour(
                   {.h_before2 = h(j), .h_before = h(j + 1), .h_after = h(j + 2)});
    }
    after2 = after;
    after = band;
  }
  return lambda * trace;
}

/// Σ(x_i − f(t_i))², each residual as λ(Qa)_i: the difference itself would drown in rounding where
/// λ is small.
double squared_residuals(const KnotRing& knots, double lambda) {
  const std::size_t n = knots.newest();
  const auto a = [&](std::size_t i) { return knots.values(i, KnotRing::kAcceleration); };
  const std::vector<double> zeros(knots.dimensions());
  std::vector<double> residual(knots.dimensions());
  double sum = 0;
  for (std::size_t i = 0; i <= n; ++i) {
    smooth_position(lambda, i > 0 ? knots.row(i - 1).h : 0, i < n ? knots.row(i).h : 0, zeros,
                    a(i > 0 ? i - 1 : 0), a(i), a(std::min(i + 1, n)), residual);
    for (const double r : residual) sum += r * r;
  }
  return sum;
}

/// Narrows down the minimum of a function between two points by golden sections.
template <typename Function>
double minimum_between(double low, double high, const Function& f) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr double kEnough = 1e-7;
  double left = high - kGolden * (high - low);
  double right = low + kGolden * (high - low);
  double at_left = f(left);
  double at_right = f(right);
  while (high - low > kEnough) {
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
  require_waypoints(waypoints);
  if (waypoints.size() < 3) {
    throw std::invalid_argument("cross-validation needs 3 waypoints; there are " +
                                std::to_string(waypoints.size()));
  }
  const Interpolant how{.method = find_method("smoothing"), .lambda = lambda, .time_scale = 1};
  require_parameters(how);
  const Condition own{.kind = ConditionKind::own, .value = {}};
  const KnotRing knots = solve_knots(waypoints, how, own, own);
  const double trace = residual_trace(knots, lambda);
  return static_cast<double>(waypoints.size()) * squared_residuals(knots, lambda) / (trace * trace);
}

double cross_validated_lambda(const Waypoints& waypoints) {
  require_waypoints(waypoints);
  if (waypoints.size() < 3) return 0;
  // From next to no smoothing of neighbours to next to a line over the whole duration; λ/h³ tells
  // the one, λ·(knots per second)/duration⁴ the other.
  const double duration = to_seconds(waypoints.times.back() - waypoints.times.front());
  const double h = duration / static_cast<double>(waypoints.size() - 1);
  const double lowest = std::log(1e-6 * h * h * h);
  const double highest = std::log(std::pow(duration, 4) / h);
  constexpr int kSteps = 60;
  const double step = (highest - lowest) / kSteps;
  const auto score = [&](double log_lambda) {
    return cross_validation_score(waypoints, std::exp(log_lambda));
  };
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

}  // namespace splinecast::core
