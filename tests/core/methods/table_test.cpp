#include "splinecast/method.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "splinecast/fit.hpp"
#include "tests/fixtures/curves/method_trial.hpp"

// The laws that each method declares, tested on random meshes. A method that is added to the
// registry is tested without a change here.
namespace splinecast::core {
namespace {

using testing::exact_options;
using testing::Function;
using testing::Mesh;
using testing::plain_options;
using testing::query_times;
using testing::random_mesh;
using testing::random_trial;
using testing::random_values;
using testing::regular_mesh;
using testing::sampled_trial;
using testing::Trial;

class Methods : public ::testing::TestWithParam<const Method*> {
 protected:
  [[nodiscard]] static const Method& method() { return *GetParam(); }
  [[nodiscard]] static PiecewisePolynomial plain(const Trial& trial) {
    return fit(trial.waypoints(), plain_options(method()));
  }
};

double largest(std::span<const double> values) {
  double most = 0;
  for (const double x : values) most = std::max(most, std::abs(x));
  return most;
}

/// Position, velocity, acceleration and jerk at a time.
std::vector<double> state_at(const PiecewisePolynomial& curve, Time t) {
  State state(curve.dimensions());
  curve.evaluate(t, state.ref());
  return {state.values().begin(), state.values().end()};
}

/// Largest value of each derivative over the mesh.
std::array<double, 4> scales(const PiecewisePolynomial& curve, const Mesh& mesh) {
  std::array<double, 4> most{};
  for (const Time t : query_times(mesh, 4)) {
    const auto state = state_at(curve, t);
    const std::size_t size = state.size() / 4;
    for (std::size_t r = 0; r < 4; ++r) {
      most[r] = std::max(most[r], largest(std::span(state).subspan(r * size, size)));
    }
  }
  return most;
}

/// The largest jump of the r-th derivative at an interior knot, as a fraction of the largest value
/// of this derivative, or of Δx/h^r between two waypoints if that is larger: a curve much smoother
/// than its waypoints has their rounding error.
double largest_jump(const PiecewisePolynomial& curve, const Mesh& mesh, std::size_t r) {
  double scale = scales(curve, mesh)[r];
  for (std::size_t i = 0; i + 1 < mesh.size(); ++i) {
    const double h = to_seconds(mesh.times[i + 1] - mesh.times[i]);
    const double step = std::abs(mesh.position(i + 1)[0] - mesh.position(i)[0]);
    scale = std::max(scale, step / std::pow(h, static_cast<double>(r)));
  }
  double most = 0;
  State before(curve.dimensions());
  for (std::size_t i = 1; i + 1 < mesh.size(); ++i) {
    const double h = to_seconds(mesh.times[i] - mesh.times[i - 1]);
    core::evaluate(curve.order_of(i - 1), curve.coefficients(i - 1), h, before.ref());
    const auto after = state_at(curve, mesh.times[i]);
    for (std::size_t d = 0; d < curve.dimensions(); ++d) {
      const std::size_t at = r * curve.dimensions() + d;
      most = std::max(most, std::abs(after[at] - before.values()[at]) / scale);
    }
  }
  return most;
}

TEST_P(Methods, PassesThroughItsWaypoints) {
  if (!method().laws.is_interpolating) GTEST_SKIP() << method().name << " does not interpolate";
  EXPECT_TRUE(rc::check("interpolates", [](std::uint64_t seed) {
    const Trial trial = random_trial(seed, 1 + seed % 40, 3, 1 + static_cast<double>(seed % 50));
    const auto curve = plain(trial);
    // On a very uneven mesh the curve overshoots, and its rounding error grows with its size.
    const double scale = std::max(largest(trial.mesh.positions), scales(curve, trial.mesh)[0]);
    for (std::size_t i = 0; i < trial.mesh.size(); ++i) {
      const auto state = state_at(curve, trial.mesh.times[i]);
      for (std::size_t d = 0; d < 3; ++d) {
        RC_ASSERT(std::abs(state[d] - trial.mesh.position(i)[d]) <= 2e-13 * scale);
      }
    }
  }));
}

TEST_P(Methods, HasTheContinuityThatItClaimsAndNoMore) {
  const auto continuity = static_cast<std::size_t>(method().laws.continuity);
  EXPECT_TRUE(rc::check("continuity", [continuity](std::uint64_t seed) {
    const Trial trial = random_trial(seed, 4 + seed % 30, 2, 4);
    const auto curve = plain(trial);
    for (std::size_t r = 0; r <= continuity; ++r) {
      RC_ASSERT(largest_jump(curve, trial.mesh, r) < 1e-9);
    }
  }));
  const Trial trial = random_trial(1, 30, 2, 4);
  EXPECT_GT(largest_jump(plain(trial), trial.mesh, continuity + 1), 1e-7);
}

/// A polynomial of the given degree with random coefficients.
Function random_polynomial(std::uint64_t seed, int degree) {
  return [c = random_values(seed, 14), degree](double t, std::size_t d, int r) {
    double value = 0;
    for (int k = degree; k >= r; --k) {
      double factor = 1;
      for (int j = 0; j < r; ++j) factor *= k - j;
      value = value * t + factor * c[7 * d + static_cast<std::size_t>(k)];
    }
    return value;
  };
}

/// The largest difference from a function in position, as a fraction of its largest value.
double difference(const PiecewisePolynomial& curve, const Mesh& mesh, const Function& f) {
  double most = 0;
  double scale = 0;
  for (const Time t : query_times(mesh, 5)) {
    const auto state = state_at(curve, t);
    for (std::size_t d = 0; d < curve.dimensions(); ++d) {
      const double wanted = f(to_seconds(t - mesh.times.front()), d, 0);
      scale = std::max(scale, std::abs(wanted));
      most = std::max(most, std::abs(state[d] - wanted));
    }
  }
  return most / scale;
}

/// A mesh with intervals of about 0.1 s, so that powers of time have similar sizes.
Mesh slow_mesh(std::uint64_t seed, std::size_t knots) {
  Mesh mesh = random_mesh(seed, knots, 2, 3);
  for (Time& t : mesh.times) t *= 10;
  return mesh;
}

TEST_P(Methods, ReproducesPolynomialsUpToItsDegreeAndNoFurther) {
  const int degree = method().laws.degree;
  const auto error = [](std::uint64_t seed, int of_degree) {
    const Function f = random_polynomial(seed, of_degree);
    const Trial trial = sampled_trial(slow_mesh(seed, 4 + seed % 20), f);
    return difference(fit(trial.waypoints(), exact_options(method(), trial)), trial.mesh, f);
  };
  EXPECT_TRUE(
      rc::check("reproduces", [&](std::uint64_t seed) { RC_ASSERT(error(seed, degree) < 1e-10); }));
  EXPECT_GT(error(3, degree + 1), 1e-9);
}

/// Applies x → A x + b to the positions and x → A x to the derivatives.
Trial mapped(const Trial& trial, const std::array<double, 4>& a, const std::array<double, 2>& b) {
  Trial result = trial;
  const auto apply = [&](std::vector<double>& values, bool shifts) {
    for (std::size_t i = 0; i + 1 < values.size(); i += 2) {
      const double x = values[i];
      const double y = values[i + 1];
      values[i] = a[0] * x + a[1] * y + (shifts ? b[0] : 0);
      values[i + 1] = a[2] * x + a[3] * y + (shifts ? b[1] : 0);
    }
  };
  apply(result.mesh.positions, true);
  apply(result.velocities, false);
  apply(result.accelerations, false);
  return result;
}

/// How far the curve of the mapped waypoints is from the mapped curve, relative to its size.
double inequivariance(const Method& method, const Trial& trial, const std::array<double, 4>& a) {
  const std::array<double, 2> b{0.5, -2};
  const auto before = fit(trial.waypoints(), plain_options(method));
  const Trial moved = mapped(trial, a, b);
  const auto after = fit(moved.waypoints(), plain_options(method));
  double most = 0;
  for (const Time t : query_times(trial.mesh, 4)) {
    const auto p = state_at(before, t);
    const auto q = state_at(after, t);
    most = std::max(most, std::abs(q[0] - (a[0] * p[0] + a[1] * p[1] + b[0])));
    most = std::max(most, std::abs(q[1] - (a[2] * p[0] + a[3] * p[1] + b[1])));
  }
  return most / largest(moved.mesh.positions);
}

TEST_P(Methods, IsEquivariantToTheAffineMapsThatItClaimsAndToNoOthers) {
  constexpr std::array<double, 4> kMirror{-1, 0, 0, 1};
  constexpr std::array<double, 4> kScale{3, 0, 0, -0.25};
  constexpr std::array<double, 4> kTurn{0.6, -0.8, 0.8, 0.6};
  const Laws& laws = method().laws;
  EXPECT_TRUE(rc::check("equivariant", [&](std::uint64_t seed) {
    const Trial trial = random_trial(seed, 2 + seed % 30, 2, 5);
    RC_ASSERT(inequivariance(method(), trial, kMirror) < 1e-11);
    if (laws.is_scale_free) RC_ASSERT(inequivariance(method(), trial, kScale) < 1e-11);
    if (laws.is_linear) RC_ASSERT(inequivariance(method(), trial, kTurn) < 1e-11);
  }));
  const Trial trial = random_trial(1, 30, 2, 5);
  EXPECT_EQ(inequivariance(method(), trial, kScale) < 1e-6, laws.is_scale_free);
  EXPECT_EQ(inequivariance(method(), trial, kTurn) < 1e-6, laws.is_linear);
}

TEST_P(Methods, ShiftingTimeChangesNoBit) {
  const Trial trial = random_trial(21, 50, 3, 5);
  Trial shifted = trial;
  const Time offset{1'700'000'000'000'000'000};
  for (Time& t : shifted.mesh.times) t += offset;
  const auto curve = plain(trial);
  const auto moved = plain(shifted);
  for (const Time t : query_times(trial.mesh, 7)) {
    EXPECT_EQ(state_at(curve, t), state_at(moved, t + offset)) << t.count();
  }
}

TEST_P(Methods, ConvergesWithTheOrderThatItClaims) {
  const Function f = [](double t, std::size_t, int r) {
    return std::pow(0.9, r) * std::exp(0.9 * t) + (r == 0 ? t : r == 1 ? 1 : 0);
  };
  // The error in the middle of two seconds, away from the ends.
  const auto error = [&](std::size_t intervals) {
    const Time h(2'000'000'000 / static_cast<std::int64_t>(intervals));
    const Trial trial = sampled_trial(regular_mesh(intervals + 1, 1, h), f);
    const auto curve = fit(trial.waypoints(), exact_options(method(), trial));
    double most = 0;
    for (int i = 0; i <= 1000; ++i) {
      const double t = 0.5 + i / 1000.0;
      const Time at(static_cast<std::int64_t>(std::llround(t * 1e9)));
      most = std::max(most, std::abs(state_at(curve, at)[0] - f(t, 0, 0)));
    }
    return most;
  };
  // Coarser for order 6: its errors soon reach the rounding error.
  const std::size_t coarse = method().laws.order_of_convergence > 4 ? 8 : 32;
  const double measured = std::log2(error(coarse) / error(2 * coarse));
  std::printf("%s converges with order %.2f\n", std::string(method().name).c_str(), measured);
  EXPECT_NEAR(measured, method().laws.order_of_convergence, 0.25);
}

TEST_P(Methods, WorksWithOneToFourWaypoints) {
  for (std::size_t knots = 1; knots <= 4; ++knots) {
    const Trial trial = random_trial(3, knots, 2, 2);
    const auto curve = plain(trial);
    EXPECT_EQ(curve.segments(), std::max<std::size_t>(knots - 1, 1));
    for (const Time t : query_times(trial.mesh, 3)) {
      for (const double x : state_at(curve, t)) EXPECT_TRUE(std::isfinite(x)) << knots;
    }
    if (knots != 2 || method().needs_velocity()) continue;
    const double h = to_seconds(trial.mesh.times[1] - trial.mesh.times[0]);
    const double chord = (trial.mesh.positions[2] - trial.mesh.positions[0]) / h;
    EXPECT_NEAR(state_at(curve, trial.mesh.times[0])[2], chord, 1e-9 * std::abs(chord));
  }
}

std::vector<const Method*> all_methods() {
  std::vector<const Method*> all;
  for (const Method& method : methods()) all.push_back(&method);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Every, Methods, ::testing::ValuesIn(all_methods()),
                         [](const auto& tested) { return std::string(tested.param->name); });

TEST(Method, IsFoundByItsUniqueNameAndNumber) {
  for (const Method& method : methods()) {
    EXPECT_EQ(find_method(method.name), &method);
    EXPECT_EQ(find_method(method.number), &method);
  }
  EXPECT_EQ(find_method("wavelet"), nullptr);
  EXPECT_EQ(find_method(std::uint64_t{999}), nullptr);
  EXPECT_EQ(&c2(), find_method("c2"));
}

TEST(Pchip, NeverOvershoots) {
  EXPECT_TRUE(rc::check("monotone between waypoints", [](std::uint64_t seed) {
    const Trial trial = random_trial(seed, 2 + seed % 30, 1, 20);
    const auto curve = fit(trial.waypoints(), plain_options(*find_method("pchip")));
    for (const Time t : query_times(trial.mesh, 20)) {
      const std::size_t i = curve.segment_at(t);
      const auto [low, high] = std::minmax(trial.mesh.positions[i], trial.mesh.positions[i + 1]);
      const double rounding = 1e-14 * (1 + std::abs(low) + std::abs(high));
      const double p = state_at(curve, t)[0];
      RC_ASSERT(p >= low - rounding);
      RC_ASSERT(p <= high + rounding);
    }
  }));
}

TEST(Akima, TreatsChordsThatDifferByRoundingAsEqual) {
  // Slope 1, then slope 10, in steps of 0.1 s: the chords of equal slope differ by an ulp at most.
  Mesh mesh = regular_mesh(9, 1, Time(100'000'000));
  mesh.positions = {0, 0.1, 0.2, 0.3, 0.4, 1.4, 2.4, 3.4, 4.4};
  const auto curve = fit({.dimensions = 1, .times = mesh.times, .positions = mesh.positions},
                         plain_options(*find_method("akima")));
  EXPECT_NEAR(state_at(curve, mesh.times[4])[1], 5.5, 1e-12);
}

TEST(Methods, RefuseValuesAbove1e100AndAreFiniteAt1e100) {
  const Mesh mesh = regular_mesh(3, 1, Time(1'000'000));
  for (const Method& method : methods()) {
    for (const double largest_value : {1e100, 1.01e100}) {
      const std::vector<double> x{0, largest_value, -largest_value};
      const Waypoints all{.dimensions = 1,
                          .times = mesh.times,
                          .positions = x,
                          .velocities = x,
                          .accelerations = x};
      if (largest_value > 1e100) {
        EXPECT_THROW((void)fit(all, plain_options(method)), std::invalid_argument);
        continue;
      }
      const auto curve = fit(all, plain_options(method));
      for (const Time t : query_times(mesh, 3)) {
        for (const double value : state_at(curve, t)) EXPECT_TRUE(std::isfinite(value));
      }
    }
  }
}

TEST(Rounded, DependsOnItsTimeScale) {
  const Trial trial = random_trial(4, 20, 1, 3);
  FitOptions options = plain_options(*find_method("rounded"));
  const auto plain = fit(trial.waypoints(), options);
  // Positions times 1000 with a time scale of 1/1000 give the same curve times 1000.
  Trial fine = trial;
  for (double& x : fine.mesh.positions) x *= 1000;
  options.interpolant.time_scale = 1e-3;
  const auto scaled = fit(fine.waypoints(), options);
  for (const Time t : query_times(trial.mesh, 3)) {
    EXPECT_NEAR(state_at(scaled, t)[0], 1000 * state_at(plain, t)[0], 1e-9);
  }
}

}  // namespace
}  // namespace splinecast::core
