#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "ipc/c/roles.hpp"
#include "splinecast/fit.hpp"
#include "tests/ipc/c/roles.hpp"

/// Each function of the C interface does what the C++ one does, bit for bit.
namespace splinecast {
namespace {

using testing::CState;
using testing::CStream;

std::vector<double> all(const State& state) {
  return {state.values().begin(), state.values().end()};
}

/// The peaks of the entry and of the motion, in the order of the struct in C.
std::vector<double> all(const ReplacePreview& preview) {
  std::vector<double> found;
  for (const MotionPeaks* motion : {&preview.entry, &preview.motion}) {
    for (const auto* values : {&motion->velocity, &motion->acceleration, &motion->jerk}) {
      found.insert(found.end(), values->begin(), values->end());
    }
  }
  return found;
}

/// Requires that two curves have the same segments and values.
void expect_equal(const splinecast_curve* curve, const PiecewisePolynomial& expected) {
  size_t segments = 0;
  EXPECT_EQ(splinecast_curve_segments(curve, &segments), 0);
  ASSERT_EQ(segments, expected.segments());
  for (std::size_t i = 0; i < segments; ++i) {
    splinecast_segment segment = SPLINECAST_SEGMENT_INIT;
    ASSERT_EQ(splinecast_curve_segment(curve, i, &segment), 0);
    EXPECT_EQ(segment.left, expected.left_of(i).count());
    EXPECT_EQ(segment.right, expected.right_of(i).count());
    const auto values = expected.coefficients(i);
    EXPECT_EQ(std::vector(segment.coefficients.data, segment.coefficients.data + values.size()),
              std::vector(values.begin(), values.end()));
  }
  State state(2);
  CState found(2);
  std::array<double, 2> jerk{};
  const splinecast_output out = {jerk.data(), 2, 1};
  for (std::int64_t t = 0; t <= expected.breaks().back().count(); t += 250'000) {
    expected.evaluate(Time(t), state.ref());
    ASSERT_EQ(splinecast_curve_evaluate(curve, t, &found.state), 0);
    EXPECT_EQ(found.values, all(state));
    ASSERT_EQ(splinecast_curve_derivative(curve, t, 3, &out), 0);
    EXPECT_EQ(jerk[1], state.jerk()[1]);
  }
}

TEST(CRoundTrip, SamplesHaveTheBitsOfTheReader) {
  const CStream c;
  c.send(20);
  c.finish();
  Reader reader(c.stream.name());
  State expected(2);
  CState found(2);
  for (std::int64_t t = -3; t < 21 * CStream::kStep; t += 7'654'321) {
    ASSERT_EQ(splinecast_reader_sample(c.reader, t, &found.state),
              static_cast<int>(reader.sample(Time(t), expected)));
    EXPECT_EQ(found.values, all(expected)) << t;
    ASSERT_EQ(splinecast_reader_preview(c.reader, t, &found.state),
              static_cast<int>(reader.preview(Time(t), expected)));
    EXPECT_EQ(found.values, all(expected)) << t;
  }
  std::int64_t settled = 0;
  EXPECT_EQ(splinecast_reader_settled_until(c.reader, &settled), 0);
  EXPECT_EQ(settled, reader.settled_until().count());
}

TEST(CRoundTrip, TheStreamIsThatOfTheProducerClass) {
  const CStream c;
  testing::TestStream other;
  Producer producer(other.name(), {.dimensions = 2,
                                   .clock = StreamClock::recorded,
                                   .start = {.kind = ConditionKind::natural, .value = {}}});
  Solver solver(other.name(), {});
  ASSERT_TRUE(solver.attach());
  std::vector<std::int64_t> times;
  std::vector<double> positions;
  for (int i = 0; i < 20; ++i) {
    const std::array x{std::sin(0.3 * i), 0.1 * i};
    ASSERT_EQ(producer.append({.time = Time(i * CStream::kStep), .position = x}),
              AppendStatus::accepted);
    times.push_back(i * CStream::kStep);
    positions.insert(positions.end(), x.begin(), x.end());
  }
  const splinecast_waypoints path = {
      {times.data(), 20, 1}, {positions.data(), 20, 2, 0, 0}, {}, {}};
  size_t appended = 0;
  ASSERT_EQ(splinecast_producer_append_many(c.producer, &path, &appended),
            SPLINECAST_APPEND_ACCEPTED);
  EXPECT_EQ(appended, 20U);
  while (solver.step(MonotonicClock()).consumed > 0) {
  }
  c.solve();
  Reader reader(other.name());
  State expected(2);
  CState found(2);
  for (std::int64_t t = 0; t < 19 * CStream::kStep; t += 7'654'321) {
    ASSERT_EQ(splinecast_reader_sample(c.reader, t, &found.state),
              static_cast<int>(reader.sample(Time(t), expected)));
    EXPECT_EQ(found.values, all(expected)) << t;
  }
}

TEST(CRoundTrip, AppendManyStopsAtTheFirstWaypointThatIsNotAccepted) {
  const CStream c;
  const std::array<std::int64_t, 4> times{0, 100, 100'000, 50'000};
  const std::array<double, 8> positions{};
  const splinecast_waypoints path = {{times.data(), 4, 1}, {positions.data(), 4, 2, 0, 0}, {}, {}};
  size_t appended = 9;
  EXPECT_EQ(splinecast_producer_append_many(c.producer, &path, &appended),
            SPLINECAST_APPEND_TOO_CLOSE);
  EXPECT_EQ(appended, 1U);
}

TEST(CRoundTrip, ManySamplesHaveTheBitsOfTheReader) {
  const CStream c;
  c.send(20);
  Reader reader(c.stream.name());
  std::vector<std::int64_t> at;
  std::vector<Time> times;
  for (int i = 0; i < 40; ++i) times.emplace_back(at.emplace_back(i * 43'000'000));
  std::vector<double> expected(40 * 4);
  std::vector<SampleStatus> expected_status(40);
  constexpr auto kSet = Derivatives::velocity | Derivatives::jerk;
  const auto revision = reader.sample_many(times, {expected, expected_status, kSet});
  std::vector<double> values(40 * 4);
  std::vector<uint8_t> status(40);
  const splinecast_times c_times = {at.data(), 40, 1};
  const splinecast_output_matrix out = {values.data(), 40, 4, 0, 0};
  uint64_t found = 0;
  ASSERT_EQ(splinecast_reader_sample_many(c.reader, &c_times,
                                          SPLINECAST_VELOCITY_VALUES + SPLINECAST_JERK_VALUES, &out,
                                          status.data(), 40, &found),
            1);
  EXPECT_EQ(found, revision);
  EXPECT_EQ(values, expected);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(status[i], static_cast<int>(expected_status[i]));
}

TEST(CRoundTrip, ASnapshotHasTheSegmentsOfTheReader) {
  const CStream c;
  c.send(20);
  Reader reader(c.stream.name());
  Snapshot expected(2);
  const auto status = reader.snapshot(Time(0), Time(5 * CStream::kStep), expected);
  splinecast_snapshot* found = nullptr;
  ASSERT_EQ(splinecast_snapshot_create(2, &found), 0);
  EXPECT_EQ(splinecast_reader_snapshot(c.reader, 0, 5 * CStream::kStep, found),
            static_cast<int>(status));
  size_t segments = 0;
  uint64_t revision = 0;
  std::int64_t settled = 0;
  EXPECT_EQ(splinecast_snapshot_segments(found, &segments), 0);
  EXPECT_EQ(splinecast_snapshot_revision(found, &revision), 0);
  EXPECT_EQ(splinecast_snapshot_settled_until(found, &settled), 0);
  EXPECT_EQ(revision, expected.revision());
  EXPECT_EQ(settled, expected.settled_until().count());
  ASSERT_EQ(segments, expected.size());
  ASSERT_GT(segments, 3U);
  const auto is = [](const splinecast_vector& vector, std::span<const double> values) {
    return std::vector(vector.data, vector.data + vector.count) ==
           std::vector(values.begin(), values.end());
  };
  for (std::size_t i = 0; i < segments; ++i) {
    splinecast_segment segment = SPLINECAST_SEGMENT_INIT;
    ASSERT_EQ(splinecast_snapshot_segment(found, i, &segment), 0);
    EXPECT_EQ(segment.left, expected[i].left.count());
    EXPECT_EQ(segment.right, expected[i].right.count());
    EXPECT_EQ(segment.kind, static_cast<int>(expected[i].kind));
    EXPECT_EQ(segment.order, expected[i].order);
    const auto& matrix = segment.coefficients;
    EXPECT_TRUE(is({matrix.data, matrix.rows * matrix.columns, 1}, expected[i].coefficients));
    EXPECT_TRUE(is(segment.waypoint, expected[i].waypoint));
    EXPECT_TRUE(is(segment.acceleration_step, expected[i].acceleration_step));
  }
  EXPECT_EQ(splinecast_snapshot_destroy(found), 0);
}

/// Waypoints after 2 s: times and positions.
std::pair<std::vector<std::int64_t>, std::vector<double>> turned_path() {
  std::pair<std::vector<std::int64_t>, std::vector<double>> path;
  for (int i = 20; i < 32; ++i) {
    path.first.push_back(i * CStream::kStep);
    path.second.insert(path.second.end(), {1 - 0.2 * i, 0.1 * i * i});
  }
  return path;
}

TEST(CRoundTrip, APreviewIsThatOfTheProducerClass) {
  const CStream c;
  c.send(20);
  const auto [times, positions] = turned_path();
  const splinecast_waypoints path = {
      {times.data(), times.size(), 1}, {positions.data(), times.size(), 2, 0, 0}, {}, {}};
  const std::int64_t t = 18 * CStream::kStep;
  std::array<double, 12> peaks{};
  splinecast_preview found = SPLINECAST_PREVIEW_INIT;
  found.entry_velocity = {&peaks[0], 2, 1};
  found.entry_acceleration = {&peaks[2], 2, 1};
  found.entry_jerk = {&peaks[4], 2, 1};
  found.motion_velocity = {&peaks[6], 2, 1};
  found.motion_acceleration = {&peaks[8], 2, 1};
  found.motion_jerk = {&peaks[10], 2, 1};
  ASSERT_EQ(splinecast_producer_preview_replace(c.producer, t, &path, 0, &found), 0);
  std::vector<Waypoint> waypoints;
  for (std::size_t i = 0; i < times.size(); ++i) {
    waypoints.push_back({.time = Time(times[i]), .position = {&positions[2 * i], 2}});
  }
  const ReplacePreview expected = c.producer->producer.preview_replace(Time(t), waypoints, {});
  ASSERT_EQ(found.status, static_cast<int>(expected.status));
  ASSERT_EQ(found.is_known, 1);
  EXPECT_EQ(found.enters, 1);
  EXPECT_EQ(found.begin, expected.begin.count());
  EXPECT_EQ(found.duration, expected.duration.count());
  EXPECT_EQ(found.enters, expected.enters ? 1 : 0);
  EXPECT_EQ(found.waypoint, expected.waypoint ? static_cast<std::int64_t>(*expected.waypoint) : -1);
  EXPECT_EQ(found.passed_over, expected.passed_over);
  EXPECT_EQ(found.worst.ratio, expected.worst.ratio);
  EXPECT_EQ(std::vector(peaks.begin(), peaks.end()), all(expected));
  ASSERT_EQ(splinecast_producer_replace_from(c.producer, t, &path, 0), SPLINECAST_APPEND_ACCEPTED);
  c.solve();
  CState state(2);
  ASSERT_TRUE(
      splinecast_has_values(splinecast_reader_preview(c.reader, times.back(), &state.state)));
  EXPECT_EQ(state.values[1], positions.back());
}

TEST(CRoundTrip, AnOutcomeIsThatOfTheProducerClass) {
  CStream c;
  c.send(3);
  c.finish();
  uint64_t item = 0;
  ASSERT_EQ(splinecast_producer_last_item(c.producer, &item), 0);
  EXPECT_EQ(item, 3U);
  for (uint64_t i = 0; i < 5; ++i) {
    const ItemOutcome expected = c.producer->producer.outcome(i);
    splinecast_outcome found = SPLINECAST_OUTCOME_INIT;
    const int kind = splinecast_producer_wait_outcome(c.producer, i, 0, &found);
    EXPECT_EQ(kind, static_cast<int>(expected.kind));
    ASSERT_EQ(splinecast_producer_outcome(c.producer, i, &found), kind);
    EXPECT_EQ(found.kind, kind);
    EXPECT_EQ(found.way, static_cast<int>(expected.way));
    EXPECT_EQ(found.reason, 0);
    EXPECT_EQ(found.is_final, expected.is_final ? 1 : 0);
    EXPECT_EQ(found.time, expected.time.value_or(Time::zero()).count());
  }
}

TEST(CRoundTrip, AStopHasNoWaypoints) {
  const CStream c;
  c.send(20);
  splinecast_preview preview = SPLINECAST_PREVIEW_INIT;
  EXPECT_EQ(
      splinecast_producer_preview_replace(c.producer, 19 * CStream::kStep, nullptr, 0, &preview),
      0);
  EXPECT_EQ(preview.enters, 0);
  EXPECT_EQ(splinecast_producer_replace_from(c.producer, 19 * CStream::kStep, nullptr, 0),
            SPLINECAST_APPEND_ACCEPTED);
  const splinecast_waypoints none = {};
  EXPECT_EQ(splinecast_producer_replace_from(c.producer, 25 * CStream::kStep, &none, 0),
            SPLINECAST_APPEND_ACCEPTED);
}

TEST(CRoundTrip, AFitHasTheBitsOfTheFunction) {
  const std::array<std::int64_t, 5> stamps{0, 1'000'000, 3'000'000, 4'000'000, 9'000'000};
  const std::array<double, 10> positions{1, 2, 3, 1, 5, 7, 2, 2, 0, 1};
  const splinecast_waypoints path = {{stamps.data(), 5, 1}, {positions.data(), 5, 2, 0, 0}, {}, {}};
  std::array<Time, 5> times;
  for (std::size_t i = 0; i < 5; ++i) times[i] = Time(stamps[i]);
  const Waypoints waypoints{.dimensions = 2, .times = times, .positions = positions};
  for (const Method& method : methods()) {
    if (method.needs_velocity()) continue;
    splinecast_fit_options options = SPLINECAST_FIT_OPTIONS_INIT;
    const std::string name(method.name);
    options.method = name.c_str();
    splinecast_curve* curve = nullptr;
    ASSERT_EQ(splinecast_fit(&path, &options, &curve), 0) << splinecast_last_error();
    const auto expected = fit(waypoints, {.interpolant = {.method = &method}});
    EXPECT_EQ(splinecast_curve_dimensions(curve), 2);
    expect_equal(curve, expected);
    EXPECT_EQ(splinecast_curve_destroy(curve), 0);
  }
  double lambda = -1;
  ASSERT_EQ(splinecast_cross_validated_lambda(&path, &lambda), 0);
  EXPECT_EQ(lambda, cross_validated_lambda(waypoints));
}

}  // namespace
}  // namespace splinecast
