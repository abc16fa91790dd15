#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/online/sliding_window.hpp"
#include "core/solvers/smoothing_rows.hpp"
#include "splinecast/fit.hpp"
#include "tests/fixtures/curves/mesh.hpp"
#include "tests/fixtures/curves/method_trial.hpp"
#include "tests/fixtures/curves/online.hpp"

namespace splinecast::core {
namespace {

using testing::Mesh;
using testing::query_times;
using testing::random_mesh;
using testing::random_values;
using testing::regular_mesh;

Waypoints waypoints_of(const Mesh& mesh) {
  return {.dimensions = mesh.dimensions, .times = mesh.times, .positions = mesh.positions};
}

FitOptions smoothing(double lambda) {
  return {.interpolant = {.method = find_method("smoothing"), .lambda = lambda}};
}

/// The matrix H that maps waypoints to smoothed positions, by dense algebra with Green and
/// Silverman's K = Q R⁻¹ Qᵀ for the roughness ∫f″². Shares no code with the library.
Eigen::MatrixXd dense_influence(const Mesh& mesh, double lambda) {
  const auto n = static_cast<Eigen::Index>(mesh.size());
  const auto h = [&](Eigen::Index i) {
    const auto at = static_cast<std::size_t>(i);
    return static_cast<double>((mesh.times[at + 1] - mesh.times[at]).count()) * 1e-9;
  };
  Eigen::MatrixXd q = Eigen::MatrixXd::Zero(n, n - 2);
  Eigen::MatrixXd r = Eigen::MatrixXd::Zero(n - 2, n - 2);
  for (Eigen::Index j = 0; j < n - 2; ++j) {
    q(j, j) = 1 / h(j);
    q(j + 1, j) = -1 / h(j) - 1 / h(j + 1);
    q(j + 2, j) = 1 / h(j + 1);
    r(j, j) = (h(j) + h(j + 1)) / 3;
    if (j + 1 < n - 2) r(j, j + 1) = r(j + 1, j) = h(j + 1) / 6;
  }
  const Eigen::MatrixXd k = q * r.ldlt().solve(q.transpose());
  return (Eigen::MatrixXd::Identity(n, n) + lambda * k)
      .ldlt()
      .solve(Eigen::MatrixXd::Identity(n, n));
}

Eigen::MatrixXd positions_of(const Mesh& mesh) {
  Eigen::MatrixXd x(static_cast<Eigen::Index>(mesh.size()),
                    static_cast<Eigen::Index>(mesh.dimensions));
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    for (Eigen::Index d = 0; d < x.cols(); ++d) {
      x(i, d) = mesh.position(static_cast<std::size_t>(i))[static_cast<std::size_t>(d)];
    }
  }
  return x;
}

TEST(Smoothing, EqualsADenseSolve) {
  for (const double ratio : {1.0, 5.0, 50.0}) {
    const Mesh mesh = random_mesh(5, 40, 2, ratio);
    for (const double lambda : {1e-9, 1e-6, 1e-4}) {
      const Eigen::MatrixXd wanted = dense_influence(mesh, lambda) * positions_of(mesh);
      const auto curve = fit(waypoints_of(mesh), smoothing(lambda));
      State state(2);
      for (std::size_t i = 0; i < mesh.size(); ++i) {
        curve.evaluate(mesh.times[i], state.ref());
        for (std::size_t d = 0; d < 2; ++d) {
          EXPECT_NEAR(state.position()[d],
                      wanted(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(d)), 1e-8)
              << "λ " << lambda << ", knot " << i;
        }
      }
    }
  }
}

TEST(Smoothing, WithLambdaZeroIsTheNaturalSpline) {
  const Mesh mesh = random_mesh(6, 60, 2, 10);
  const auto curve = fit(waypoints_of(mesh), smoothing(0));
  const auto spline = fit(waypoints_of(mesh), {});
  State a(2);
  State b(2);
  for (const Time t : query_times(mesh, 5)) {
    curve.evaluate(t, a.ref());
    spline.evaluate(t, b.ref());
    for (std::size_t d = 0; d < 2; ++d) EXPECT_NEAR(a.position()[d], b.position()[d], 1e-12);
  }
}

/// The least-squares line: its value at the first knot and its slope, of each dimension.
Eigen::MatrixXd line_through(const Mesh& mesh) {
  const auto n = static_cast<Eigen::Index>(mesh.size());
  Eigen::MatrixXd basis(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    basis(i, 0) = 1;
    basis(i, 1) = to_seconds(mesh.times[static_cast<std::size_t>(i)] - mesh.times.front());
  }
  return basis.colPivHouseholderQr().solve(positions_of(mesh));
}

TEST(Smoothing, WithGrowingLambdaTendsToTheLeastSquaresLine) {
  const Mesh mesh = random_mesh(7, 40, 2, 4);
  const Eigen::MatrixXd line = line_through(mesh);
  State state(2);
  double before = std::numeric_limits<double>::infinity();
  for (const double lambda : {1e-3, 1.0, 1e3}) {
    const auto curve = fit(waypoints_of(mesh), smoothing(lambda));
    double error = 0;
    for (const Time t : query_times(mesh, 3)) {
      curve.evaluate(t, state.ref());
      for (Eigen::Index d = 0; d < 2; ++d) {
        const double wanted = line(0, d) + line(1, d) * to_seconds(t - mesh.times.front());
        error = std::max(error, std::abs(state.position()[static_cast<std::size_t>(d)] - wanted));
      }
    }
    EXPECT_LT(error, before / 10);
    before = error;
  }
  EXPECT_LT(before, 1e-5);
}

TEST(Smoothing, KeepsItsDigitsWithManyKnotsAndLargeLambda) {
  Mesh mesh = regular_mesh(20'000, 1, Time(1'000'000));
  mesh.positions = random_values(1, mesh.size());
  const Eigen::MatrixXd line = line_through(mesh);
  const double duration = to_seconds(mesh.times.back() - mesh.times.front());
  State state(1);
  for (const double lambda : {1e14, 1e30}) {
    const auto curve = fit(waypoints_of(mesh), smoothing(lambda));
    curve.evaluate(mesh.times.front(), state.ref());
    EXPECT_NEAR(state.position()[0], line(0, 0), 1e-9) << lambda;
    curve.evaluate(mesh.times.back(), state.ref());
    EXPECT_NEAR(state.position()[0], line(0, 0) + line(1, 0) * duration, 1e-9) << lambda;
  }
}

TEST(Smoothing, TwoWaypointsANanosecondApartDisturbNothing) {
  // A nanosecond apart, with λ/h³ = 1e25: two waypoints at practically the same time.
  Mesh mesh = regular_mesh(9, 1, Time(10'000'000));
  mesh.positions = {0, 0.2, 0.4, 0.6, 0.8, 1.0, 0.9, 1.1, 1.0};
  const auto smooth = fit(waypoints_of(mesh), smoothing(0.01));
  Mesh close = mesh;
  close.times.insert(close.times.begin() + 4, mesh.times[3] + Time(1));
  State state(1);
  smooth.evaluate(mesh.times[3] + Time(1), state.ref());
  // A waypoint on the curve does not change the curve.
  close.positions.insert(close.positions.begin() + 4, state.position()[0]);
  const auto curve = fit(waypoints_of(close), smoothing(0.01));
  State other(1);
  for (const Time t : query_times(mesh, 5)) {
    smooth.evaluate(t, state.ref());
    curve.evaluate(t, other.ref());
    EXPECT_NEAR(other.position()[0], state.position()[0], 1e-12) << t.count();
    EXPECT_NEAR(other.velocity()[0], state.velocity()[0], 1e-10) << t.count();
  }
}

TEST(Smoothing, ALargeOffsetOfThePositionsCostsNoDigitsOfTheDerivatives) {
  Mesh mesh = regular_mesh(50, 1, Time(1'000'000));
  for (std::size_t i = 0; i < 50; ++i) {
    // Multiples of 2⁻²⁰, so that adding 2³⁰ loses nothing.
    mesh.positions.push_back(std::round(std::sin(0.02 * static_cast<double>(i)) * 0x1p20) / 0x1p20);
  }
  Mesh far = mesh;
  for (double& x : far.positions) x += 0x1p30;
  const auto near_curve = fit(waypoints_of(mesh), smoothing(1e-6));
  const auto far_curve = fit(waypoints_of(far), smoothing(1e-6));
  WindowOptions how{.interpolant = smoothing(1e-6).interpolant, .settle = 64};
  how.accepts_short_lag = true;
  const auto online = testing::online(waypoints_of(far), how, {ConditionKind::own, {}});
  State a(1);
  State b(1);
  State c(1);
  for (const Time t : query_times(mesh, 4)) {
    near_curve.evaluate(t, a.ref());
    far_curve.evaluate(t, b.ref());
    online.evaluate(t, c.ref());
    EXPECT_NEAR(a.velocity()[0], b.velocity()[0], 1e-11 * 20);
    EXPECT_NEAR(a.acceleration()[0], b.acceleration()[0], 1e-9 * 230);
    EXPECT_NEAR(a.velocity()[0], c.velocity()[0], 1e-7 * 20);
    EXPECT_NEAR(a.acceleration()[0], c.acceleration()[0], 1e-6 * 230);
  }
}

TEST(Smoothing, ACurveOfTwoWaypointsKeepsTheConditionsOfBothEnds) {
  Mesh mesh = regular_mesh(2, 1, Time(1'000'000'000));
  mesh.positions = {0, 1};
  FitOptions options = smoothing(1);
  options.start = {ConditionKind::acceleration, {1}};
  options.end = {ConditionKind::acceleration, {2}};
  const auto curve = fit(waypoints_of(mesh), options);
  State state(1);
  curve.evaluate(mesh.times[0], state.ref());
  EXPECT_NEAR(state.acceleration()[0], 1, 1e-12);
  curve.evaluate(mesh.times[1], state.ref());
  EXPECT_NEAR(state.acceleration()[0], 2, 1e-12);
}

TEST(CrossValidation, ScoresWithTheExactTrace) {
  for (const double ratio : {1.0, 5.0}) {
    const Mesh mesh = random_mesh(8, 30, 3, ratio);
    for (const double lambda : {1e-9, 1e-6, 1e-3}) {
      const Eigen::MatrixXd h = dense_influence(mesh, lambda);
      const Eigen::MatrixXd x = positions_of(mesh);
      const double n = 30;
      const double wanted = n * (x - h * x).squaredNorm() / std::pow(n - h.trace(), 2);
      EXPECT_NEAR(cross_validation_score(waypoints_of(mesh), lambda) / wanted, 1, 1e-6);
    }
  }
}

/// A sine and a cosine with noise of the given size.
Mesh noisy_sine(std::size_t knots, double noise) {
  Mesh mesh = regular_mesh(knots, 2, Time(10'000'000));
  const auto random = random_values(3, 2 * knots);
  for (std::size_t i = 0; i < knots; ++i) {
    const double t = to_seconds(mesh.times[i]);
    mesh.positions.push_back(std::sin(6 * t) + noise * random[2 * i]);
    mesh.positions.push_back(std::cos(4 * t) + noise * random[2 * i + 1]);
  }
  return mesh;
}

TEST(CrossValidation, ChoosesTheLeastScoreAndRemovesHalfOfTheNoise) {
  const Mesh mesh = noisy_sine(200, 0.05);
  const double lambda = cross_validated_lambda(waypoints_of(mesh));
  const double score = cross_validation_score(waypoints_of(mesh), lambda);
  for (double other = 1e-12; other < 1e3; other *= 3) {
    EXPECT_LE(score, cross_validation_score(waypoints_of(mesh), other) * (1 + 1e-9)) << other;
  }
  const auto curve = fit(waypoints_of(mesh), smoothing(lambda));
  State state(2);
  double error = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    curve.evaluate(mesh.times[i], state.ref());
    error += std::pow(state.position()[0] - std::sin(6 * to_seconds(mesh.times[i])), 2);
  }
  EXPECT_LT(std::sqrt(error / 200), 0.05 / std::sqrt(3.0) / 2);  // half of the noise is gone
}

TEST(CrossValidation, ChangesSmoothDataByLessThan1eMinus5) {
  const Mesh mesh = noisy_sine(200, 0);
  const auto curve = fit(waypoints_of(mesh), smoothing(cross_validated_lambda(waypoints_of(mesh))));
  State state(2);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    curve.evaluate(mesh.times[i], state.ref());
    EXPECT_NEAR(state.position()[0], mesh.position(i)[0], 1e-5);
  }
  EXPECT_EQ(cross_validated_lambda(waypoints_of(mesh.first(2))), 0);
}

/// Largest acceleration step at a knot of the settled curve, as a fraction of the peak acceleration
/// of the batch curve.
double step_left(double ratio, std::size_t lag) {
  const Mesh mesh = noisy_sine(600, 0.05);
  const double h = 0.01;
  WindowOptions how{.interpolant = smoothing(ratio * h * h * h).interpolant, .settle = lag};
  how.accepts_short_lag = true;
  const auto segments =
      testing::settled_segments(waypoints_of(mesh), how, {ConditionKind::own, {}});
  const auto batch = fit(waypoints_of(mesh), smoothing(ratio * h * h * h));
  State state(2);
  double peak = 0;
  for (const Time t : query_times(mesh, 4)) {
    batch.evaluate(t, state.ref());
    for (const double a : state.acceleration()) peak = std::max(peak, std::abs(a));
  }
  double step = 0;
  for (const Segment& segment : segments) {
    for (const double s : segment.acceleration_step) step = std::max(step, std::abs(s));
  }
  return step / peak;
}

TEST(Smoothing, TheErrorDecaysWithTheLagAndIsAHundredthOrLessAtTheRequiredLag) {
  for (const double ratio : {0.1, 1.0, 10.0, 100.0, 500.0}) {
    double before = std::numeric_limits<double>::infinity();
    for (const std::size_t lag : {4U, 8U, 16U, 32U, 64U}) {
      const double left = step_left(ratio, lag);
      std::printf("λ/h³ %g, lag %zu: step %.2g of the peak acceleration\n", ratio, lag, left);
      EXPECT_LT(left, std::max(before, 1e-9));
      before = left;
    }
    const double lag = smoothing_lag(ratio * 1e-6, 0.01);
    EXPECT_LT(step_left(ratio, static_cast<std::size_t>(std::ceil(lag))), 1e-2) << ratio;
  }
}

TEST(Smoothing, OnlineWithALongLagEqualsTheBatchWithinTheStatedBound) {
  const Mesh mesh = noisy_sine(400, 0.05);
  // λ/h³ = 1: a lag of 13 leaves an error of a thousandth, one of 64 a negligible error.
  const double lambda = 1e-6;
  const auto online = testing::online(waypoints_of(mesh),
                                      {.interpolant = smoothing(lambda).interpolant, .settle = 64},
                                      {ConditionKind::own, {}});
  const auto batch = fit(waypoints_of(mesh), smoothing(lambda));
  State a(2);
  State b(2);
  for (const Time t : query_times(mesh, 4)) {
    online.evaluate(t, a.ref());
    batch.evaluate(t, b.ref());
    for (std::size_t d = 0; d < 2; ++d) {
      EXPECT_NEAR(a.position()[d], b.position()[d], 1e-12);
      EXPECT_NEAR(a.velocity()[d], b.velocity()[d], 1e-10);
      EXPECT_NEAR(a.acceleration()[d], b.acceleration()[d], 1e-7);
    }
  }
}

TEST(Smoothing, RefusesALagTooShortForItsLambdaUnlessForced) {
  const auto how = [](std::size_t lag, double lambda, bool force) {
    WindowOptions options{.interpolant = smoothing(lambda).interpolant, .settle = lag};
    options.accepts_short_lag = force;
    return options;
  };
  EXPECT_THROW(SlidingWindow(1, how(12, 0, false)), std::invalid_argument);
  EXPECT_NO_THROW(SlidingWindow(1, how(12, 0, true)));
  const double zero = 0;
  for (const bool force : {false, true}) {
    // λ/h³ = 10 at 10 ms requires a lag of 24.
    for (const std::size_t lag : {23U, 24U}) {
      SlidingWindow window(1, how(lag, 1e-5, force));
      for (std::size_t i = 0; i < lag; ++i) {
        const Time t(static_cast<std::int64_t>(i) * 10'000'000);
        ASSERT_TRUE(window.lag_suffices(t));  // nothing settles yet
        window.append({.time = t, .position = {&zero, 1}});
      }
      const Time next(static_cast<std::int64_t>(lag) * 10'000'000);
      EXPECT_EQ(window.lag_suffices(next), force || lag == 24) << lag;
      EXPECT_TRUE(window.lag_suffices(next + Time(20'000'000)));
    }
  }
}

}  // namespace
}  // namespace splinecast::core
