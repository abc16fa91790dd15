#include "splinecast/dimension_kind.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "ipc/options/stream.hpp"
#include "ipc/sampling/sampler.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/options.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/time.hpp"
#include "tests/fixtures/curves/rotation.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// Streams with periodic dimensions or quaternions, through ring, solver, board and sampler.
namespace splinecast::ipc {
namespace {

constexpr Time kPeriod = std::chrono::milliseconds(10);
constexpr double kH = 0.01;
constexpr int kWaypoints = 500;
constexpr std::size_t kSettle = 16;

/// A linear dimension, which must stay unchanged, and a quaternion.
DimensionKinds pose_kinds() {
  std::vector<Dimension> dimensions(5, {.kind = DimensionKind::quaternion});
  dimensions[0] = {};
  return DimensionKinds(dimensions);
}

/// A stream of `pose_kinds` with the waypoints of a coning rotation.
class ConingStream {
 public:
  /// With `flips`, every waypoint has a random sign and length, and a solver takes over halfway.
  explicit ConingStream(bool flips, std::string_view method = "c2")
      : stream_(5, {.interpolant = {.method = find_method(method)}, .settle = kSettle}, 64, 1024,
                {}, pose_kinds()),
        sampler_(stream_.board.reader, StreamClock::recorded, pose_kinds()) {
    std::mt19937_64 random(7);  // NOLINT(*-msc51-cpp): the same flips in every run
    for (int i = 0; i < kWaypoints; ++i) {
      const double factor = flips ? static_cast<double>(1 + random() % 3) : 1;
      const double sign = flips && random() % 2 == 0 ? -1 : 1;
      std::vector<double> x{static_cast<double>(i)};
      for (const double value : coning_.quaternion(i * kH)) x.push_back(sign * factor * value);
      stream_.send({.time = i * kPeriod, .position = x});
      if (flips && i == kWaypoints / 2) {
        stream_.drain();
        stream_.replace_solver();
      }
    }
    stream_.finish({.kind = ConditionKind::natural});
  }

  [[nodiscard]] State at(Time t) {
    State state(5);
    EXPECT_EQ(sampler_.sample(t, state.ref()), SampleStatus::settled);
    return state;
  }
  [[nodiscard]] const testing::Coning& coning() const { return coning_; }
  [[nodiscard]] Sampler& sampler() { return sampler_; }

 private:
  testing::Coning coning_;
  testing::MemoryStream stream_;
  Sampler sampler_;
};

AngularMotion motion_of(const State& state) {
  return angular_motion({.first = 1}, state.position(), state.velocity(), state.acceleration());
}

/// The state that readers see u seconds after the start of a segment.
State seen_at(const SegmentCopy& segment, double u) {
  State state(5);
  core::evaluate(segment.order, segment.coefficients, u, state.ref());
  pose_kinds().normalise(state.ref());
  return state;
}

TEST(QuaternionStream, AccelerationStepsOfASnapshotAreThoseThatReadersSee) {
  for (const std::string_view method : {"c2", "akima", "pchip", "bessel"}) {
    ConingStream stream(true, method);
    BoardSnapshot snapshot(5);
    ASSERT_EQ(stream.sampler().snapshot(100 * kPeriod, 200 * kPeriod, snapshot),
              SampleStatus::settled);
    double largest = 0;
    double off = 0;
    for (std::size_t i = 1; i < snapshot.segments().size(); ++i) {
      const SegmentCopy& before = snapshot.segments()[i - 1];
      const SegmentCopy& after = snapshot.segments()[i];
      const State left = seen_at(before, to_seconds(before.right - before.left));
      const State right = seen_at(after, 0);
      for (std::size_t d = 0; d < 5; ++d) {
        const double seen = right.acceleration()[d] - left.acceleration()[d];
        largest = std::max(largest, std::abs(seen));
        off = std::max(off, std::abs(seen - after.acceleration_step[d]));
      }
    }
    EXPECT_LT(off, 1e-9) << method << ", of steps up to " << largest;
    if (method != "c2") {
      EXPECT_GT(largest, 1e-3) << method;
    }
  }
}

double length_of(std::span<const double> q) {
  return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
}

TEST(QuaternionStream, AngularMotionEqualsTheRotationsWithinTheErrorBoundOfTheSpline) {
  ConingStream stream(true);
  double velocity = 0;
  double acceleration = 0;
  double off_unit = 0;
  // Not near the ends: the error of the boundary condition decays by a factor of 0.27 per waypoint,
  // to 2e-17 after 30 waypoints.
  for (Time t = 30 * kPeriod; t <= (kWaypoints - 30) * kPeriod; t += Time(1'234'567)) {
    const State state = stream.at(t);
    const AngularMotion got = motion_of(state);
    const AngularMotion wanted = stream.coning().motion(to_seconds(t));
    velocity = std::max(velocity, testing::difference(got.velocity, wanted.velocity));
    acceleration =
        std::max(acceleration, testing::difference(got.acceleration, wanted.acceleration));
    off_unit = std::max(off_unit, std::abs(length_of(state.position().subspan(1)) - 1));
  }
  // The error of a complete cubic spline is at most h³M/24 in the first and 3h²M/8 in the second
  // derivative, where M is the largest fourth derivative (Hall and Meyer 1976). ω and α are twice a
  // product with a unit quaternion. The factor 1.1 covers the position error, which is of order h⁴.
  const double m = stream.coning().derivative_bound(4);
  const double velocity_bound = 1.1 * 2 * kH * kH * kH * m / 24;
  const double acceleration_bound = 1.1 * 2 * 3 * kH * kH * m / 8;
  std::printf("largest error: omega %.3g rad/s (bound %.3g), alpha %.3g rad/s2 (bound %.3g)\n",
              velocity, velocity_bound, acceleration, acceleration_bound);
  EXPECT_LT(velocity, velocity_bound);
  EXPECT_LT(acceleration, acceleration_bound);
  EXPECT_LT(off_unit, 1e-15);
}

TEST(QuaternionStream, SignsAndLengthsOfTheWaypointsDoNotMatter) {
  ConingStream plain(false);
  ConingStream flipped(true);
  const double sign =
      plain.at(Time(0)).position()[4] * flipped.at(Time(0)).position()[4] < 0 ? -1 : 1;
  double difference = 0;
  double step = 0;
  State before = flipped.at(Time(0));
  for (Time t{}; t < (kWaypoints - 1) * kPeriod; t += Time(1'000'000)) {
    const State one = plain.at(t);
    const State other = flipped.at(t);
    for (std::size_t d = 0; d < 5; ++d) {
      const double factor = d == 0 ? 1 : sign;
      difference = std::max(difference, std::abs(one.position()[d] - factor * other.position()[d]));
      if (d > 0) step = std::max(step, std::abs(other.position()[d] - before.position()[d]));
    }
    before = other;
  }
  EXPECT_LT(difference, 1e-14);
  // In 1 ms each component changes by at most its speed times 1 ms: there is no jump.
  EXPECT_LT(step, 1.01e-3 * plain.coning().derivative_bound(1));
}

TEST(QuaternionStream, GivenVelocitiesChangeSignWithTheirQuaternion) {
  const Method* const method = find_method("hermite");
  const std::vector<Dimension> four(4, {.kind = DimensionKind::quaternion});
  const DimensionKinds kinds(four);
  testing::MemoryStream stream(4, {.interpolant = {.method = method}, .settle = 1}, 64, 1024, {},
                               kinds);
  const testing::Coning coning;
  constexpr double kStep = 1e-4;
  for (int i = 0; i < 50; ++i) {
    const double sign = i % 3 == 0 ? -1 : 1;
    std::vector<double> x(4);
    std::vector<double> v(4);
    for (std::size_t d = 0; d < 4; ++d) {
      const auto at = [&](double t) { return sign * coning.quaternion(t)[d]; };
      x[d] = at(i * kH);
      v[d] = (at(i * kH + kStep) - at(i * kH - kStep)) / (2 * kStep);
    }
    stream.send({.time = i * kPeriod, .position = x, .velocity = v});
  }
  stream.finish({.kind = ConditionKind::own});
  Sampler sampler(stream.board.reader, StreamClock::recorded, kinds);
  State state(4);
  for (Time t{}; t < 49 * kPeriod; t += Time(777'777)) {
    ASSERT_EQ(sampler.sample(t, state.ref()), SampleStatus::settled);
    const auto motion =
        angular_motion({}, state.position(), state.velocity(), state.acceleration());
    const auto wanted = coning.motion(to_seconds(t));
    EXPECT_LT(testing::difference(motion.velocity, wanted.velocity), 1e-4) << t.count();
  }
}

TEST(QuaternionStream, AQuaternionOfLengthZeroIsRefused) {
  testing::MemoryStream stream(5, {}, 64, 1024, {}, pose_kinds());
  stream.send({.time = Time(0), .position = std::vector<double>{1, 0, 0, 0, 1}});
  stream.send({.time = kPeriod, .position = std::vector<double>{1, 0, 0, 0, 0}});
  stream.send({.time = 2 * kPeriod, .position = std::vector<double>{1, 0, 1, 0, 0}});
  stream.finish();
  const Summary& summary = stream.solver.summary();
  EXPECT_EQ(summary.knots, 2U);
  EXPECT_EQ(summary.refused, 1U);
  EXPECT_EQ(summary.reasons[static_cast<std::size_t>(Refusal::zero_quaternion)], 1U);
}

TEST(QuaternionStream, HoldsAndStopsAtUnitLength) {
  const core::WindowOptions how{.settle = 2, .start = {.kind = ConditionKind::halt, .value = {}}};
  testing::MemoryStream stream(5, how, 64, 1024, {}, pose_kinds());
  const testing::Coning coning;
  for (int i = 0; i < 20; ++i) {
    std::vector<double> x{0};
    for (const double value : coning.quaternion(i * kH)) x.push_back(value);
    stream.send({.time = i * kPeriod, .position = x});
  }
  stream.drain();
  Sampler sampler(stream.board.reader, StreamClock::monotonic, pose_kinds());
  State state(5);
  for (const Time t : {Time(-5), 19 * kPeriod + Time(100'000'000), 100 * kPeriod}) {
    ASSERT_TRUE(has_values(sampler.sample(t, state.ref())));
    EXPECT_NEAR(length_of(state.position().subspan(1)), 1, 1e-15);
  }
  EXPECT_EQ(sampler.sample(100 * kPeriod, state.ref()), SampleStatus::holding);
  EXPECT_EQ(motion_of(state).velocity, Vector3{});
}

/// A heading that turns at a constant rate, wrapped into [0, P) as a compass gives it.
TEST(PeriodicStream, AHeadingKeepsItsRateOverManyTurns) {
  EXPECT_TRUE(rc::check([] {
    const double period = *rc::gen::element(360.0, 6.283185307179586, 1.0);
    const double rate = period * (*rc::gen::inRange(-90, 91) / 10.0);  // turns per second
    const DimensionKinds kinds(
        std::vector<Dimension>{{.kind = DimensionKind::periodic, .period = period}});
    testing::MemoryStream stream(1, {}, 64, 1024, {}, kinds);
    const auto wrapped = [&](double x) { return x - period * std::floor(x / period); };
    for (int i = 0; i < 200; ++i) {
      const double heading = wrapped(rate * i * kH);
      stream.send({.time = i * kPeriod, .position = std::span(&heading, 1)});
    }
    stream.finish({.kind = ConditionKind::natural});
    Sampler sampler(stream.board.reader, StreamClock::recorded, kinds);
    State state(1);
    for (Time t{}; t <= 199 * kPeriod; t += Time(3'333'333)) {
      RC_ASSERT(sampler.sample(t, state.ref()) == SampleStatus::settled);
      const double x = state.position()[0];
      RC_ASSERT(x >= -period / 2);
      RC_ASSERT(x < period / 2);
      RC_ASSERT(std::abs(std::remainder(x - rate * to_seconds(t), period)) < 1e-9 * period);
      RC_ASSERT(std::abs(state.velocity()[0] - rate) < 1e-8 * period);
    }
  }));
}

TEST(StreamKinds, AProducersKindsAreInTheHeader) {
  const std::vector<Dimension> kinds{{.kind = DimensionKind::periodic, .period = 360}, {}};
  const RegionHeader header = make_header({.dimensions = 2, .kinds = kinds}, 1);
  EXPECT_EQ(dimensions_of(header), kinds);
  EXPECT_FALSE(dimension_kinds(header).all_linear());
  EXPECT_TRUE(dimension_kinds(make_header({.dimensions = 2}, 1)).all_linear());
}

TEST(StreamKinds, InvalidKindsAreRefused) {
  const auto refusal = [](std::size_t dimensions,
                          const std::vector<Dimension>& kinds) -> std::string {
    try {
      (void)make_header({.dimensions = dimensions, .kinds = kinds}, 1);
    } catch (const BadRequest& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal(2, {{}}), "1 kinds for 2 dimensions");
  EXPECT_NE(refusal(1, {{.kind = DimensionKind::periodic, .period = -3}}).find("period -3"),
            std::string::npos);
  EXPECT_NE(refusal(2, {{}, {.kind = DimensionKind::quaternion}}).find("at dimension 1"),
            std::string::npos);
}

TEST(StreamKinds, AContinuedStreamKeepsItsKinds) {
  const testing::TestStream stream;
  const std::vector<Dimension> kinds{{.kind = DimensionKind::periodic, .period = 360}};
  { const Producer first(stream.name(), {.dimensions = 1, .kinds = kinds}); }
  EXPECT_NO_THROW(Producer(stream.name(), {.dimensions = 1, .kinds = kinds}));
  for (const std::vector<Dimension>& other :
       {std::vector<Dimension>{}, {{.kind = DimensionKind::periodic, .period = 2}}}) {
    EXPECT_THROW(Producer(stream.name(), {.dimensions = 1, .kinds = other}), BadRequest);
  }
  Producer again(stream.name(), {.dimensions = 1, .kinds = kinds});
  again.withdraw();
}

}  // namespace
}  // namespace splinecast::ipc
