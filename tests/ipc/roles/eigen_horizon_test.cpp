#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "splinecast/eigen.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/allocations.hpp"
#include "tests/fixtures/processes/process.hpp"

/// EigenHorizon, compared with Reader::sample_many into plain memory.
namespace splinecast {
namespace {

using testing::TestStream;

constexpr std::size_t kTimes = 50;
constexpr Time kSpacing{10'000'000};  // of the waypoints

/// A finished stream of D dimensions, whose waypoints are Eigen vectors, and a reader of it.
template <int D>
class EigenStream {
 public:
  EigenStream()
      : producer_(stream_.name(), {.dimensions = D, .clock = StreamClock::recorded, .start = {}}),
        solver_(stream_.name(), {}) {
    EXPECT_TRUE(solver_.attach());
    Eigen::Matrix<double, D, 1> x;
    for (int i = 0; i < 40; ++i) {
      for (int d = 0; d < D; ++d) x[d] = std::sin(0.2 * i + d);
      EXPECT_EQ(producer_.append(as_waypoint(i * kSpacing, x)), AppendStatus::accepted);
    }
    EXPECT_EQ(producer_.finish({}), AppendStatus::accepted);
    const MonotonicClock clock;
    while (solver_.step(clock).consumed > 0) {
    }
    reader.emplace(stream_.name());
  }

 private:
  TestStream stream_;
  Producer producer_;
  Solver solver_;

 public:
  std::optional<Reader> reader;
};

/// Samples the horizon, and expects in it the bits, statuses and revision of a plain block.
template <int D, Derivatives kStored>
void sample_and_compare(Reader& reader, EigenHorizon<D, kStored>& horizon) {
  std::vector<double> values(kTimes * count(kStored) * reader.dimensions());
  std::vector<SampleStatus> status(kTimes, SampleStatus::busy);
  const auto revision = reader.sample_many(
      horizon.times(), {.values = values, .status = status, .derivatives = kStored});
  ASSERT_GT(revision, 0U);
  ASSERT_EQ(reader.sample_many(horizon.times(), horizon), revision);
  EXPECT_TRUE(std::ranges::equal(horizon.status(), status));
  ASSERT_EQ(static_cast<std::size_t>(horizon.states().size()), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_EQ(std::bit_cast<std::uint64_t>(horizon.states().data()[i]),
              std::bit_cast<std::uint64_t>(values[i]))
        << i;
  }
}

/// Expects that column i of each derivative is the state at time i.
template <int D>
void expect_columns(Reader& reader, const EigenHorizon<D>& horizon) {
  State state(reader.dimensions());
  for (std::size_t i = 0; i < horizon.size(); ++i) {
    ASSERT_TRUE(has_values(reader.preview(horizon.times()[i], state)));
    const auto column = static_cast<Eigen::Index>(i);
    EXPECT_TRUE(horizon.position().col(column) == as_vector(state.position())) << i;
    EXPECT_TRUE(horizon.velocity().col(column) == as_vector(state.velocity())) << i;
    EXPECT_TRUE(horizon.acceleration().col(column) == as_vector(state.acceleration())) << i;
    EXPECT_TRUE(horizon.jerk().col(column) == as_vector(state.jerk())) << i;
  }
}

TEST(EigenHorizon, OfFixedDimensionsHasTheBitsOfSampleMany) {
  EigenStream<3> stream;
  EigenHorizon<3> horizon(kTimes);
  horizon.set_times(Time(17), Time(6'123'457));
  EXPECT_EQ(horizon.times()[2], Time(17 + 2 * 6'123'457));
  sample_and_compare(*stream.reader, horizon);
  EXPECT_TRUE(horizon.is_complete());
  expect_columns(*stream.reader, horizon);
}

TEST(EigenHorizon, OfDynamicDimensionsHasTheBitsOfSampleMany) {
  EigenStream<3> stream;
  EigenHorizon<> horizon(kTimes, stream.reader->dimensions());
  horizon.set_times(Time(17), Time(6'123'457));
  sample_and_compare(*stream.reader, horizon);
  EXPECT_EQ(horizon.position().rows(), 3);
  EXPECT_EQ(horizon.position().cols(), static_cast<Eigen::Index>(kTimes));
  expect_columns(*stream.reader, horizon);
}

TEST(EigenHorizon, OfOneDimensionHasRowsOfStates) {
  EigenStream<1> stream;
  EigenHorizon<1> horizon(kTimes);
  horizon.set_times(Time(0), kSpacing / 2);
  sample_and_compare(*stream.reader, horizon);
  expect_columns(*stream.reader, horizon);
  EigenHorizon<1, Derivatives::velocity> speeds(kTimes);
  speeds.set_times(Time(0), kSpacing / 2);
  sample_and_compare(*stream.reader, speeds);
  EXPECT_TRUE(speeds.velocity() == horizon.velocity());
}

template <class T>
constexpr bool kHasVelocity = requires(const T& horizon) {
  horizon.velocity();
};

TEST(EigenHorizon, StoresTheRequestedDerivativesOnly) {
  EigenStream<3> stream;
  EigenHorizon<3> all(kTimes);
  EigenHorizon<3, Derivatives::position | Derivatives::acceleration> fixed(kTimes);
  EigenHorizon<Eigen::Dynamic, Derivatives::velocity | Derivatives::jerk> dynamic(kTimes, 3);
  const auto sample = [&](auto& horizon) {
    horizon.set_times(Time(5), Time(7'000'000));
    sample_and_compare(*stream.reader, horizon);
  };
  sample(all);
  sample(fixed);
  sample(dynamic);
  EXPECT_EQ(fixed.states().rows(), 6);
  EXPECT_TRUE(fixed.position() == all.position());
  EXPECT_TRUE(fixed.acceleration() == all.acceleration());
  EXPECT_TRUE(dynamic.velocity() == all.velocity());
  EXPECT_TRUE(dynamic.jerk() == all.jerk());
  static_assert(kHasVelocity<decltype(all)> && !kHasVelocity<decltype(fixed)>);
}

TEST(EigenHorizon, HasNoDataBeforeItIsSampledAndNoneOfOtherDimensions) {
  EigenStream<3> stream;
  EigenHorizon<> horizon(2, 4);
  EXPECT_FALSE(horizon.is_complete());
  EXPECT_EQ(horizon.status()[1], SampleStatus::no_data);
  EXPECT_TRUE(horizon.states().isZero(0));
  EXPECT_EQ(stream.reader->sample_many(horizon.times(), horizon.block()), 0U);
  EXPECT_EQ(horizon.status()[1], SampleStatus::wrong_dimension);
  EXPECT_FALSE(horizon.is_complete());
}

TEST(EigenHorizon, IsNotCompleteIfOneTimeHasNoValues) {
  EigenStream<3> stream;
  EigenHorizon<3> horizon(2);
  horizon.times()[0] = kSpacing;
  horizon.times()[1] = -kSpacing;  // before the recording
  EXPECT_GT(stream.reader->sample_many(horizon.times(), horizon.block()), 0U);
  EXPECT_TRUE(has_values(horizon.status()[0]));
  EXPECT_FALSE(horizon.is_complete());
}

/// A step of a controller: samples the horizon and sums the squares of the tracking errors.
template <int D>
double tracking_cost(Reader& reader, EigenHorizon<D>& horizon, EigenState<D>& state, Time now) {
  horizon.set_times(now, kSpacing / 10);
  if (reader.sample_many(horizon.times(), horizon) == 0) return -1;
  if (!has_values(reader.sample(now, state))) return -1;
  const double position = (horizon.position().colwise() - state.position).squaredNorm();
  return position + (horizon.velocity().colwise() - state.velocity).squaredNorm();
}

TEST(EigenHorizon, ALoopAllocatesNothing) {
  EigenStream<3> stream;
  EigenHorizon<3> fixed(kTimes);
  EigenHorizon<> dynamic(kTimes, 3);
  EigenState<3> fixed_state;
  EigenState<> dynamic_state(3);
  const std::size_t before = testing::allocations();
  double sum = 0;
  bool are_equal = true;
  for (int i = 0; i < 300; ++i) {
    const Time now = i * kSpacing / 10;
    const double of_fixed = tracking_cost(*stream.reader, fixed, fixed_state, now);
    are_equal &= of_fixed == tracking_cost(*stream.reader, dynamic, dynamic_state, now);
    sum += of_fixed;
  }
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_GT(sum, 0);
  EXPECT_TRUE(are_equal);
  const EigenHorizon<> copy(dynamic);
  EXPECT_GE(testing::allocations(), before + 3);  // which counts the allocations of Eigen too
}

}  // namespace
}  // namespace splinecast
