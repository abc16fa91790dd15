#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "splinecast/fit.hpp"
#include "splinecast/method.hpp"
#include "tests/fixtures/curves/method_trial.hpp"

// Adding a constant to every value shifts the curve and changes nothing else, except by the
// rounding of the positions. Encoder readings are the hard case: many of their chords are equal, or
// differ only by rounding.
namespace splinecast::core {
namespace {

using testing::plain_options;

constexpr std::size_t kKnots = 4000;
constexpr double kInterval = 0.002;

/// The log of a robot arm's joint at 500 Hz, in steps of `quantum`: alternately rest and constant
/// speed, with ramps of constant acceleration between them.
std::vector<double> joint_log(double quantum) {
  std::vector<double> positions;
  double x = 0.3;
  double v = 0;
  for (std::size_t i = 0; i < kKnots; ++i) {
    const std::size_t at = i % 1000;
    const double a = at < 100 ? 4.0 : at >= 400 && at < 500 ? -4.0 : 0;
    positions.push_back(std::round(x / quantum) * quantum);
    x += v * kInterval + a * kInterval * kInterval / 2;
    v += a * kInterval;
  }
  return positions;
}

std::vector<double> velocities(const Method& method, std::vector<double> positions, double offset) {
  for (double& x : positions) x += offset;
  std::vector<Time> times;
  for (std::size_t i = 0; i < kKnots; ++i) {
    times.emplace_back(static_cast<std::int64_t>(i) * 2'000'000);
  }
  // Some methods need derivatives. Their values do not matter here.
  const std::vector<double> zeros(kKnots);
  const auto curve = fit({.dimensions = 1,
                          .times = times,
                          .positions = positions,
                          .velocities = zeros,
                          .accelerations = zeros},
                         plain_options(method));
  std::vector<double> v;
  for (std::size_t i = 0; i < curve.segments(); ++i) v.push_back(curve.coefficients(i)[1]);
  return v;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

TEST(Offset, ChangesNoVelocityOfALogBeyondRounding) {
  // Readings of an encoder with 2^20 lines, exact in binary, and decimals of a text file.
  for (const double quantum : {std::numbers::pi / (1U << 20U), 1.0 / (1U << 18U), 1e-5, 1e-4}) {
    const auto log = joint_log(quantum);
    for (const Method& method : methods()) {
      const auto wanted = velocities(method, log, 0);
      const double peak = std::abs(*std::ranges::max_element(wanted));
      for (const double offset : {4.0, -4.0, 1e3, 1e6}) {
        const double found = largest_difference(velocities(method, log, offset), wanted);
        // The rounding error of a position is ε·|x|, that of a chord ε·|x|/h. The relative error of
        // weights that are a few quanta is ε·|x|/quantum.
        const double position = std::abs(offset) * std::numeric_limits<double>::epsilon();
        const double tolerance = 4 * position / kInterval + position / quantum * peak;
        EXPECT_LT(found, std::max(tolerance, 1e-9 * peak))
            << method.name << ", offset " << offset << ", quantum " << quantum;
      }
    }
  }
}

}  // namespace
}  // namespace splinecast::core
