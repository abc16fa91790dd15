#include <gtest/gtest.h>

#include "core/online/sliding_window.hpp"
#include "tests/fixtures/curves/polynomial_trajectory.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

namespace splinecast::core {
namespace {

TEST(SlidingWindowAgainstPolynomials, TheFigureEightIsMetWithin2eMinus5InPosition) {
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
  double worst[2] = {0, 0};
  Segment segment(mesh.dimensions);
  State state(mesh.dimensions);
  std::size_t next = 0;
  const auto compare = [&] {
    for (; next < window.settled_segments(); ++next) {
      window.segment(next, segment);
      for (int k = 0; k <= 20; ++k) {
        const Time u = (segment.right - segment.left) * k / 20;
        evaluate(segment.order, segment.coefficients, to_seconds(u), state.ref());
        for (int derivative = 0; derivative < 2; ++derivative) {
          const auto exact = trajectory.at(to_seconds(segment.left + u), derivative);
          for (std::size_t d = 0; d < mesh.dimensions; ++d) {
            const auto at = static_cast<std::size_t>(derivative) * mesh.dimensions + d;
            worst[derivative] =
                std::max(worst[derivative], std::abs(state.values()[at] - exact[d]));
          }
        }
      }
    }
  };
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    window.append({mesh.times[i], mesh.position(i)});
    compare();
  }
  window.finish(velocity_at(mesh.times.back()));
  compare();
  EXPECT_EQ(next + 1, mesh.size());
  EXPECT_LE(worst[0], 2e-5);
  EXPECT_LE(worst[1], 5e-4);
  std::printf("largest error: position %.3g, velocity %.3g\n", worst[0], worst[1]);
}

}  // namespace
}  // namespace splinecast::core
