#include "splinecast/eigen.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "splinecast/fit.hpp"

/// Waypoints and states as Eigen vectors, compared with the functions that take spans.
namespace splinecast {
namespace {

template <int Rows, int Columns>
using RowMajor = Eigen::Matrix<double, Rows, Columns, Eigen::RowMajor>;

/// Waypoints of three dimensions, with velocities.
struct EigenRecording {
  static constexpr int kWaypoints = 12;
  std::vector<Time> times;
  RowMajor<Eigen::Dynamic, 3> positions{kWaypoints, 3}, velocities{kWaypoints, 3};

  EigenRecording() {
    for (int i = 0; i < kWaypoints; ++i) {
      times.push_back(Time(10'000'000 * i + 1000 * i * i));
      positions.row(i) << std::sin(0.4 * i), 0.1 * i * i, 1 / (1.0 + i);
      velocities.row(i) << std::cos(0.4 * i), 0.2 * i, -0.1;
    }
  }
  /// The same waypoints, made of spans.
  [[nodiscard]] Waypoints plain() const {
    const auto size = static_cast<std::size_t>(positions.size());
    return {.dimensions = 3,
            .times = times,
            .positions = {positions.data(), size},
            .velocities = {velocities.data(), size}};
  }
};

void expect_same_memory(std::span<const double> a, std::span<const double> b) {
  EXPECT_EQ(a.data(), b.data());
  EXPECT_EQ(a.size(), b.size());
}

/// Expects the bits of the curve through the recording.
void expect_curve(const Waypoints& waypoints, const EigenRecording& recording) {
  const FitOptions options{.interpolant = {.method = find_method("hermite")}};
  const PiecewisePolynomial curve = fit(waypoints, options);
  const PiecewisePolynomial expected = fit(recording.plain(), options);
  ASSERT_EQ(curve.segments(), expected.segments());
  for (std::size_t i = 0; i < curve.segments(); ++i) {
    EXPECT_TRUE(std::ranges::equal(curve.coefficients(i), expected.coefficients(i))) << i;
  }
}

TEST(Eigen, AVectorIsAViewOfTheSampledValues) {
  const State state(3);
  EXPECT_EQ(as_vector(state.velocity()).data(), state.velocity().data());
  EXPECT_EQ(as_vector(state.velocity()).size(), 3);
  EXPECT_EQ(as_vector<3>(state.velocity()).data(), state.velocity().data());
}

TEST(Eigen, AWaypointIsAViewOfFixedAndDynamicVectors) {
  const Eigen::Vector3d x(1, 2, 3);
  Eigen::VectorXd v = Eigen::VectorXd::Constant(3, 4);
  const Eigen::RowVectorXd a = Eigen::RowVectorXd::Constant(3, 5);
  const Waypoint all = as_waypoint(Time(7), x, v, a);
  EXPECT_EQ(all.time, Time(7));
  expect_same_memory(all.position, {x.data(), 3});
  expect_same_memory(all.velocity, {v.data(), 3});
  expect_same_memory(all.acceleration, {a.data(), 3});
  EXPECT_TRUE(as_waypoint(Time(7), x, v).acceleration.empty());
  EXPECT_TRUE(as_waypoint(Time(7), x).velocity.empty());
}

TEST(Eigen, AWaypointIsAViewOfPartsOfAMatrixMapsAndReferences) {
  const Eigen::MatrixXd columns = Eigen::MatrixXd::Random(6, 4);
  const Waypoint parts = as_waypoint(Time(1), columns.col(2).head<3>(), columns.col(2).tail(3));
  expect_same_memory(parts.position, {columns.data() + 12, 3});
  expect_same_memory(parts.velocity, {columns.data() + 15, 3});
  const RowMajor<4, 6> rows = RowMajor<4, 6>::Random();
  expect_same_memory(as_span(rows.row(2)), {rows.data() + 12, 6});
  const std::vector<double> values(5);
  expect_same_memory(as_span(as_vector(values)), values);
  const Eigen::Ref<const Eigen::VectorXd> reference(columns.col(1));
  expect_same_memory(as_span(reference), {columns.data() + 6, 6});
}

TEST(Eigen, ARecordingOfRowsHasTheCurveOfItsSpans) {
  const EigenRecording recording;
  expect_curve(as_waypoints(recording.times, recording.positions, recording.velocities), recording);
  const RowMajor<EigenRecording::kWaypoints, 3> fixed = recording.positions;
  expect_curve(as_waypoints(recording.times, fixed, recording.velocities), recording);
  expect_same_memory(as_waypoints(recording.times, fixed).positions, {fixed.data(), 36});
}

TEST(Eigen, ARecordingOfColumnsIsTransposedWithoutACopy) {
  const EigenRecording recording;
  const Eigen::MatrixXd positions = recording.positions.transpose();
  const Eigen::Matrix3Xd velocities = recording.velocities.transpose();
  const Waypoints waypoints =
      as_waypoints(recording.times, positions.transpose(), velocities.transpose());
  expect_same_memory(waypoints.velocities, {velocities.data(), 36});
  expect_curve(waypoints, recording);
}

TEST(Eigen, ARecordingOfOneDimensionIsAVector) {
  const std::vector<Time> times{Time(1), Time(2), Time(4)};
  const Eigen::Vector3d x(1, 2, 3);
  const Waypoints waypoints = as_waypoints(times, x);
  EXPECT_EQ(waypoints.dimensions, 1U);
  expect_same_memory(waypoints[2].position, {&x[2], 1});
}

TEST(Eigen, ARecordingOfOtherShapesIsRefusedWithTheShapes) {
  const EigenRecording recording;
  const auto message = [&](auto&&... matrices) -> std::string {
    try {
      (void)as_waypoints(recording.times, matrices...);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const RowMajor<Eigen::Dynamic, Eigen::Dynamic> wide(12, 5), short_one(11, 3);
  EXPECT_EQ(
      message(short_one),
      "a matrix of 11 x 3 values, 3 from row to row; expected 12 contiguous rows of 3 values, "
      "one per time");
  EXPECT_EQ(
      message(recording.positions, wide),
      "a matrix of 12 x 5 values, 5 from row to row; expected 12 contiguous rows of 3 values, "
      "one per time");
  const auto part = wide.leftCols(3);
  EXPECT_EQ(
      message(part),
      "a matrix of 12 x 3 values, 5 from row to row; expected 12 contiguous rows of 3 values, "
      "one per time");
  EXPECT_EQ(message(recording.positions), "");
}

TEST(Eigen, AStateHasTheBitsOfTheEvaluatedCurve) {
  const EigenRecording recording;
  const PiecewisePolynomial curve = fit(recording.plain(), {});
  State expected(3);
  EigenState<3> fixed;
  EigenState<> dynamic(3);
  const auto expect_equal = [&](const auto& state) {
    EXPECT_TRUE(as_vector(expected.position()) == state.position);
    EXPECT_TRUE(as_vector(expected.velocity()) == state.velocity);
    EXPECT_TRUE(as_vector(expected.acceleration()) == state.acceleration);
    EXPECT_TRUE(as_vector(expected.jerk()) == state.jerk);
  };
  expect_equal(fixed);  // zero
  for (Time t = recording.times.front(); t <= recording.times.back(); t += Time(700'001)) {
    curve.evaluate(t, expected.ref());
    evaluate(curve, t, fixed);
    evaluate(curve, t, dynamic);
    expect_equal(fixed);
    expect_equal(dynamic);
  }
}

TEST(Eigen, AStateOfOtherDimensionsIsRefusedWithBothNumbers) {
  const PiecewisePolynomial curve = fit(EigenRecording().plain(), {});
  EigenState<> other(4);
  try {
    evaluate(curve, curve.breaks()[0], other);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "a curve of 3 dimensions, a state of 4");
  }
}

TEST(Eigen, StatesOfFixedSizeAreAlignedOnTheHeapAndViewsNeedNoAlignment) {
  const std::vector<EigenState<4>> states(3);
  const auto one = std::make_unique<EigenState<2>>();
  const auto rest = [](const double* p, std::size_t alignment) {
    return reinterpret_cast<std::uintptr_t>(p) % alignment;
  };
  for (const auto& state : states) EXPECT_EQ(rest(state.jerk.data(), alignof(Eigen::Vector4d)), 0U);
  EXPECT_EQ(rest(one->velocity.data(), alignof(Eigen::Vector2d)), 0U);
  alignas(32) const std::array<double, 6> values{0, 1, 2, 3, 4, 5};
  const auto odd = as_vector<4>(std::span(values).subspan(1, 4));
  EXPECT_EQ((2 * odd).eval(), Eigen::Vector4d(2, 4, 6, 8));
}

}  // namespace
}  // namespace splinecast
