#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/process.hpp"

/// What a reader reports about a stream, through the public headers only.
namespace splinecast {
namespace {

using testing::TestStream;

constexpr Time kStep{100'000'000};
constexpr int kWaypoints = 20;

/// A finished stream of two dimensions, and a reader of it.
class PublicReader : public ::testing::Test {
 protected:
  PublicReader()
      : producer_(stream_.name(), {.dimensions = 2,
                                   .names = {"x", "y"},
                                   .units = {"m", "rad"},
                                   .clock = StreamClock::recorded,
                                   .start = {}}),
        solver_(stream_.name(), {}) {
    EXPECT_TRUE(solver_.attach());
  }

  void send_all() {
    const MonotonicClock clock;
    for (int i = 0; i < kWaypoints; ++i) {
      const std::array x{std::sin(0.3 * i), 0.1 * i * i};
      ASSERT_EQ(producer_.append({.time = i * kStep, .position = x}), AppendStatus::accepted);
    }
    ASSERT_EQ(producer_.finish({}), AppendStatus::accepted);
    while (solver_.step(clock).consumed > 0) {
    }
  }

  TestStream stream_;
  Producer producer_;
  Solver solver_;
};

TEST_F(PublicReader, ReportsTheProgressOfTheCurve) {
  const Reader reader(stream_.name());
  EXPECT_FALSE(reader.progress().has_value());
  EXPECT_FALSE(reader.first_time().has_value());
  send_all();
  const auto progress = reader.progress();
  ASSERT_TRUE(progress.has_value());
  EXPECT_GT(progress->revision, 0U);
  EXPECT_EQ(progress->newest, (kWaypoints - 1) * kStep);
  EXPECT_EQ(progress->settled_until, (kWaypoints - 1) * kStep);
  EXPECT_TRUE(progress->is_finished);
  EXPECT_EQ(progress->waypoints, static_cast<std::uint64_t>(kWaypoints));
  EXPECT_EQ(progress->refused, 0U);
  EXPECT_EQ(reader.first_time(), Time::zero());
}

TEST_F(PublicReader, ReportsTheNamesAndUnitsOfTheProducer) {
  const Reader reader(stream_.name());
  EXPECT_EQ(reader.names(), (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(reader.units(), (std::vector<std::string>{"m", "rad"}));
}

TEST_F(PublicReader, ASnapshotEqualsTheSampledCurve) {
  send_all();
  Reader reader(stream_.name());
  Snapshot snapshot(reader.dimensions());
  EXPECT_EQ(snapshot.size(), 0U);
  const Time end = (kWaypoints - 1) * kStep;
  ASSERT_EQ(reader.snapshot(Time::zero(), end, snapshot), SampleStatus::settled);
  ASSERT_EQ(snapshot.size(), static_cast<std::size_t>(kWaypoints - 1));
  EXPECT_EQ(snapshot.revision(), reader.progress()->revision);
  EXPECT_EQ(snapshot.settled_until(), end);
  PiecewisePolynomial curve(snapshot.dimensions());
  for (std::size_t i = 0; i < snapshot.size(); ++i) {
    const SnapshotSegment segment = snapshot[i];
    EXPECT_EQ(segment.kind, SegmentKind::spline);
    curve.append(segment.left, segment.right, segment.order, segment.coefficients);
    ASSERT_EQ(segment.waypoint.size(), 2U);
    EXPECT_EQ(segment.waypoint[0], segment.coefficients[0]);
  }
  State sampled(2);
  State evaluated(2);
  for (Time t{}; t < end; t += kStep / 7) {
    ASSERT_EQ(reader.sample(t, sampled), SampleStatus::settled);
    curve.evaluate(t, evaluated.ref());
    ASSERT_TRUE(std::ranges::equal(sampled.values(), evaluated.values())) << t.count();
  }
}

TEST_F(PublicReader, ASnapshotWithAnotherNumberOfDimensionsIsRefused) {
  send_all();
  Reader reader(stream_.name());
  Snapshot snapshot(3);
  EXPECT_EQ(reader.snapshot(Time::zero(), kStep, snapshot), SampleStatus::wrong_dimension);
  EXPECT_EQ(snapshot.size(), 0U);
}

}  // namespace
}  // namespace splinecast
