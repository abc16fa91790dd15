#include "core/limits/extremes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace splinecast::core {
namespace {

/// A random cubic or quintic of one dimension: the whole of it or a part.
class RandomPart {
 public:
  explicit RandomPart(std::uint64_t seed) : random_(seed) {}

  SegmentPart next() {
    const int order = between(0, 1) < 0.5 ? kCubicOrder : kMaxOrder;
    h_ = std::pow(10, between(-6, 3));
    c_.fill(0);
    const double kind = between(0, 1);
    for (std::size_t k = 0; k < size(order); ++k) c_[k] = between(-1, 1);
    if (kind < 0.2) make_nearly_linear();
    if (kind > 0.8) make_double_roots(order);
    if (kind > 0.5 && kind < 0.7) make_sparse();
    const double scale = std::pow(10, between(-30, 30));
    double power = scale;
    for (std::size_t k = 0; k < size(order); ++k, power /= h_) c_[k] *= power;
    const bool is_whole = between(0, 1) < 0.5;
    const double from = is_whole ? 0 : h_ * between(0, 0.9);
    return {.order = order,
            .coefficients = std::span<const double>(c_).first(size(order)),
            .dimensions = 1,
            .from = from,
            .to = is_whole ? h_ : from + (h_ - from) * between(0, 1)};
  }

 private:
  static std::size_t size(int order) { return static_cast<std::size_t>(order); }

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  void make_nearly_linear() {
    for (std::size_t k = 2; k < c_.size(); ++k) c_[k] *= std::pow(10, between(-18, 0));
  }

  void make_sparse() {
    for (double& c : c_) c *= between(0, 1) < 0.3 ? 0 : std::pow(10, between(-12, 0));
  }

  /// Makes the velocity a product of factors (s − root), two of them equal or nearly equal.
  void make_double_roots(int order) {
    const double root = between(0, 1);
    const double near = between(0, 1) < 0.5 ? root : root + 1e-8 * between(-1, 1);
    std::vector<double> roots{root, near};
    if (order == kMaxOrder) roots.insert(roots.end(), {between(-1, 1), between(-1, 1)});
    if (between(0, 1) < 0.3) roots.back() = root;
    std::array<double, kMaxOrder> velocity{1};
    for (const double r : roots) {
      for (std::size_t k = velocity.size(); k-- > 0;) {
        velocity[k] = (k == 0 ? 0 : velocity[k - 1]) - r * velocity[k];
      }
    }
    for (std::size_t k = 1; k < size(order); ++k) c_[k] = velocity[k - 1] / static_cast<double>(k);
  }

  std::mt19937_64 random_;
  double h_ = 1;
  std::array<double, kMaxOrder> c_{};
};

double value_at(const SegmentPart& part, int derivative, double u) {
  double value = 0;
  evaluate_derivative(part.order, part.coefficients, u, derivative, {&value, 1});
  return value;
}

/// The maximum of sign · value near the i-th of n + 1 samples, by ternary search.
double refined(const SegmentPart& part, int derivative, double sign, int i, int n) {
  const double step = (part.to - part.from) / n;
  double low = std::max(part.from, part.from + step * (i - 1));
  double high = std::min(part.to, part.from + step * (i + 1));
  for (int round = 0; round < 60; ++round) {
    const double a = low + (high - low) / 3;
    const double b = high - (high - low) / 3;
    const bool is_left =
        sign * value_at(part, derivative, a) >= sign * value_at(part, derivative, b);
    (is_left ? high : low) = is_left ? b : a;
  }
  return sign * value_at(part, derivative, low);
}

/// The maximum of sign · value over n + 1 samples; with `refines`, also around each sample that is
/// not less than its neighbours.
double sampled(const SegmentPart& part, int derivative, double sign, int n, bool refines) {
  std::vector<double> values;
  for (int i = 0; i <= n; ++i) {
    const double u = i == n ? part.to : part.from + (part.to - part.from) * i / n;
    values.push_back(sign * value_at(part, derivative, u));
  }
  double most = *std::ranges::max_element(values);
  for (int i = 1; refines && i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (values[at] < values[at - 1] || values[at] < values[at + 1]) continue;
    most = std::max(most, refined(part, derivative, sign, i, n));
  }
  return most;
}

/// Expects that every extreme is a value of the curve and that no sample is beyond it.
void expect_extremes(const SegmentPart& part, int samples, bool refines) {
  std::array<SegmentRange, 4> ranges;
  write_ranges(part, 0, Derivatives::all, ranges);
  for (int m = 0; m < 4; ++m) {
    const SegmentRange range = range_of(part.order, part.coefficients, 1, 0, m, part.from, part.to);
    const SegmentRange& among = ranges[static_cast<std::size_t>(m)];
    ASSERT_EQ(range.least.value, among.least.value);
    ASSERT_EQ(range.greatest.value, among.greatest.value);
    const double rounding = kExtremeRounding * size_of_terms(part, 0, m);
    for (const auto& [sign, extreme] : {std::pair(-1.0, range.least), {1.0, range.greatest}}) {
      ASSERT_GE(extreme.u, part.from);
      ASSERT_LE(extreme.u, part.to);
      ASSERT_EQ(extreme.value, value_at(part, m, extreme.u));
      ASSERT_GE(sign * extreme.value + rounding, sampled(part, m, sign, samples, refines))
          << "derivative " << m << ", order " << part.order;
    }
  }
}

TEST(SegmentExtremes, AreValuesOfTheCurveAndNoSampleIsBeyondThem) {
  RandomPart parts(1);
  for (int i = 0; i < 1'000'000; ++i) {
    expect_extremes(parts.next(), 5, false);
    if (HasFatalFailure()) FAIL() << "segment " << i;
  }
}

TEST(SegmentExtremes, EqualTheExtremesOfDenseRefinedSamples) {
  RandomPart parts(2);
  for (int i = 0; i < 10'000; ++i) {
    expect_extremes(parts.next(), 100, true);
    if (HasFatalFailure()) FAIL() << "segment " << i;
  }
}

TEST(SegmentExtremes, OfAMinimumJerkMoveMatchTheClosedForm) {
  // x = 10 s³ − 15 s⁴ + 6 s⁵ over a second: v peaks in the middle at 15/8, a at 10/√3.
  const std::vector<double> c{0, 0, 0, 10, -15, 6};
  const SegmentRange velocity = range_of(6, c, 1, 0, 1, 0, 1);
  EXPECT_NEAR(velocity.greatest.value, 1.875, 1e-15);
  EXPECT_NEAR(velocity.greatest.u, 0.5, 1e-8);
  const SegmentRange acceleration = range_of(6, c, 1, 0, 2, 0, 1);
  EXPECT_NEAR(acceleration.greatest.value, 10 / std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(acceleration.least.value, -10 / std::sqrt(3.0), 1e-14);
  const SegmentRange jerk = range_of(6, c, 1, 0, 3, 0, 1);
  EXPECT_EQ(jerk.greatest.value, 60);
  EXPECT_NEAR(jerk.least.value, -30, 1e-13);
  EXPECT_NEAR(range_of(6, c, 1, 0, 1, 0.6, 1).greatest.value, value_at({6, c, 1, 0, 1}, 1, 0.6),
              1e-15);
}

TEST(SegmentExtremes, OfAConstantEqualTheConstantAndOfNaNAreNaN) {
  const std::vector<double> hold{3};
  EXPECT_EQ(range_of(1, hold, 1, 0, 0, 0, 1).greatest.value, 3);
  EXPECT_EQ(range_of(1, hold, 1, 0, 1, 0, 1).least.value, 0);
  const std::vector<double> bad{0, std::numeric_limits<double>::quiet_NaN(), 1, 1, 1, 1};
  EXPECT_TRUE(std::isnan(range_of(6, bad, 1, 0, 1, 0, 1).largest().value));
}

}  // namespace
}  // namespace splinecast::core
