#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/online/sliding_window.hpp"
#include "tests/fixtures/curves/polynomial_trajectory.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

namespace splinecast::core {
namespace {

/// The largest errors of a window's settled segments against a trajectory.
class Errors {
 public:
  Errors(const testing::PolynomialTrajectory& trajectory, std::size_t dimensions)
      : trajectory_(trajectory), segment_(dimensions), state_(dimensions) {}

  /// Compares the segments that have settled since the last call.
  void compare(const SlidingWindow& window) {
    for (; next_ < window.settled_segments(); ++next_) {
      window.segment(next_, segment_);
      for (int k = 0; k <= 20; ++k) {
        const Time u = (segment_.right - segment_.left) * k / 20;
        evaluate(segment_.order, segment_.coefficients, to_seconds(u), state_.ref());
        for (const int derivative : {0, 1}) compare(segment_.left + u, derivative);
      }
    }
  }
  [[nodiscard]] std::size_t compared() const { return next_; }
  /// The largest error: 0: of the position; 1: of the velocity.
  [[nodiscard]] double worst(std::size_t derivative) const { return worst_[derivative]; }

 private:
  void compare(Time t, int derivative) {
    const auto exact = trajectory_.at(to_seconds(t), derivative);
    const auto r = static_cast<std::size_t>(derivative);
    for (std::size_t d = 0; d < exact.size(); ++d) {
      worst_[r] = std::max(worst_[r], std::abs(state_.values()[r * exact.size() + d] - exact[d]));
    }
  }

  const testing::PolynomialTrajectory& trajectory_;
  Segment segment_;
  State state_;
  std::array<double, 2> worst_{};
  std::size_t next_ = 0;
};

TEST(SlidingWindowAgainstPolynomials, TheFigureEightIsReproducedWithin2eMinus5InPosition) {
  const auto path = testing::shared_file("data/crazyswarm2_poly/figure8.csv");
  REQUIRE_SHARED_FILE(path);
  const testing::PolynomialTrajectory trajectory(path);
  const testing::Mesh mesh = trajectory.sampled(Time(100'000'000));
  const auto velocity_at = [&](Time t) {
    const auto v = trajectory.at(to_seconds(t), 1);
    return Condition{ConditionKind::velocity, {v.begin(), v.end()}};
  };
  SlidingWindow window(
      mesh.dimensions,
      {.settle = 4, .tail = Tail::natural, .start = velocity_at(mesh.times.front())});
  Errors errors(trajectory, mesh.dimensions);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    window.append({mesh.times[i], mesh.position(i)});
    errors.compare(window);
  }
  window.finish(velocity_at(mesh.times.back()));
  errors.compare(window);
  EXPECT_EQ(errors.compared() + 1, mesh.size());
  EXPECT_LE(errors.worst(0), 2e-5);
  EXPECT_LE(errors.worst(1), 5e-4);
  std::printf("largest error: position %.3g, velocity %.3g\n", errors.worst(0), errors.worst(1));
}

}  // namespace
}  // namespace splinecast::core
