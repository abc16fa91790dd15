#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "core/limits/check.hpp"
#include "core/limits/extremes.hpp"
#include "ipc/verification/settled_segments.hpp"
#include "ipc/verification/verify.hpp"
#include "tests/fixtures/curves/method_trial.hpp"
#include "tests/fixtures/curves/streaming_methods.hpp"
#include "tests/fixtures/streams/item_record.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// Ends of live streams that slow down on their path.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;

constexpr Time kStart = std::chrono::seconds(100);
constexpr double kRadius = 0.1;  // m
constexpr double kPace = 5;      // rad/s: a velocity of 0.5 m/s and an acceleration of 2.5 m/s²

/// A point on a circle of radius kRadius, with its derivatives. It begins at rest.
struct Point {
  std::vector<double> position;
  std::vector<double> velocity;
  std::vector<double> acceleration;
};

Point point_at(double t) {
  constexpr double kRise = 0.3;
  const double decay = std::exp(-t / kRise);
  const double angle = kPace * (t - kRise * (1 - decay));
  const double pace = kPace * (1 - decay);
  const double rise = kPace / kRise * decay;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {{kRadius * c, kRadius * s},
          {-kRadius * s * pace, kRadius * c * pace},
          {-kRadius * (c * pace * pace + s * rise), -kRadius * (s * pace * pace - c * rise)}};
}

/// A live stream on that circle, with a waypoint every 10 ms, that is finished before its last
/// waypoint's time.
class OnCircle : public testing::MemoryStream {
 public:
  explicit OnCircle(core::WindowOptions how, DimensionKinds dimension_kinds = {}, int period = 10)
      : MemoryStream(2, from_rest(std::move(how)), 1024, 1024, {}, std::move(dimension_kinds),
                     LiveOptions{.history = std::chrono::seconds(4)}),
        period_(period),
        items_(2),
        collected_(board.reader, true) {
    clock.time = kStart;
  }

  static core::WindowOptions from_rest(core::WindowOptions how) {
    how.start = {.kind = ConditionKind::halt, .value = {}};
    how.held_before_start = true;
    return how;
  }

  /// Sends the waypoints up to `last`, each one `lead` before its time, and finishes.
  void run(int last, int lead) {
    for (int ms = 50; ms <= last; ms += period_) {
      run_to(ms - lead);
      const Point at = point_at((ms - 50) / 1e3);
      ASSERT_EQ(append({.time = kStart + milliseconds(ms),
                        .position = at.position,
                        .velocity = window.interpolant.method->needs_velocity()
                                        ? std::span<const double>(at.velocity)
                                        : std::span<const double>{},
                        .acceleration = window.interpolant.method->needs_acceleration()
                                            ? std::span<const double>(at.acceleration)
                                            : std::span<const double>{}}),
                AppendStatus::accepted);
    }
    step();
    passed_over_before_ = solver.summary().passed_over;
    ASSERT_EQ(
        ring.writer.finish({.kind = ConditionKind::halt, .value = {}}, {board.reader.consumed()}),
        AppendStatus::accepted);
    for (int i = 0; i < 1000 && !solver.summary().finished; ++i) step();
    ASSERT_TRUE(solver.summary().finished);
  }
  void run_to(int ms) {
    for (; clock.time < kStart + milliseconds(ms); clock.time += milliseconds(1)) step();
  }
  void step() {
    note();
    solver.step(clock);
    note();
  }
  void note() {
    items_.note_items(ring.reader);
    items_.note_refusals(board.reader, solver.summary().refused);
    collected_.look();
  }

  [[nodiscard]] std::string verified() const {
    const Verification found = verify({.window = window,
                                       .kinds = kinds,
                                       .items = items_.items(),
                                       .segments = collected_.segments(),
                                       .summary = collected_.summary(),
                                       .end = {.kind = ConditionKind::halt, .value = {}}});
    if (!found.first) return found.equal == collected_.segments().size() ? "" : "not all compared";
    return std::to_string(found.first->segment) + ": " + found.first->what + ", " +
           found.first->published + " published, " + found.first->solved + " solved";
  }
  [[nodiscard]] std::vector<SegmentCopy> of_kind(SegmentKind kind) const;
  [[nodiscard]] std::vector<SegmentCopy> slowed() const { return of_kind(SegmentKind::slowed); }
  /// Waypoints that the end passes over.
  [[nodiscard]] Word passed_over_by_end() const {
    return solver.summary().passed_over - passed_over_before_;
  }
  /// The largest acceleration of the spline before it slows down.
  [[nodiscard]] double path_acceleration() const;
  /// The largest distance of the spline from the circle before it slows down.
  [[nodiscard]] double path_error() const;

 private:
  int period_;  // ms
  testing::ItemRecord items_;
  SettledSegments collected_;
  Word passed_over_before_ = 0;
};

/// Calls take(state) for some points of each segment.
void for_points(const std::vector<SegmentCopy>& segments, const auto& take) {
  State state(2);
  for (const SegmentCopy& s : segments) {
    for (int i = 0; i <= 20; ++i) {
      core::evaluate(s.order, s.coefficients, to_seconds(s.right - s.left) * i / 20, state.ref());
      take(state);
    }
  }
}

/// The largest distance from the circle.
double largest_error(const std::vector<SegmentCopy>& segments) {
  double most = 0;
  for_points(segments, [&](const State& at) {
    most = std::max(most, std::abs(std::hypot(at.position()[0], at.position()[1]) - kRadius));
  });
  return most;
}

double largest_acceleration(const std::vector<SegmentCopy>& segments) {
  double most = 0;
  for_points(segments, [&](const State& at) {
    for (const double a : at.acceleration()) most = std::max(most, std::abs(a));
  });
  return most;
}

core::WindowOptions limited(const Method& method, double acceleration) {
  core::WindowOptions how = testing::plain_window(method);
  if (acceleration > 0) how.limits.acceleration = {acceleration, acceleration};
  return how;
}

std::vector<SegmentCopy> OnCircle::of_kind(SegmentKind kind) const {
  std::vector<SegmentCopy> found;
  for (const SegmentCopy& s : collected_.segments()) {
    if (s.kind == kind) found.push_back(s);
  }
  return found;
}

double OnCircle::path_acceleration() const {
  return largest_acceleration(of_kind(SegmentKind::spline));
}

double OnCircle::path_error() const { return largest_error(of_kind(SegmentKind::spline)); }

class SlowedEndOfMethods : public ::testing::TestWithParam<const Method*> {};

TEST_P(SlowedEndOfMethods, StaysOnThePathWithinTheLimit) {
  for (const double limit : {0.0, 5.0}) {  // 0: what the motion shows
    OnCircle live(limited(*GetParam(), limit));
    live.run(2000, 500);
    const Summary& summary = live.solver.summary();
    ASSERT_EQ(summary.ending(), EndKind::slowed);
    const auto slowed = live.slowed();
    const Time lateness = summary.end_lateness;
    EXPECT_EQ(summary.settled_until, kStart + milliseconds(2000) + lateness);
    EXPECT_EQ(slowed.back().right, summary.settled_until);
    EXPECT_EQ(slowed.front().left, kStart + milliseconds(2000) - lateness);
    EXPECT_EQ(lateness, static_cast<int>(slowed.size()) * milliseconds(10));
    EXPECT_LE(lateness, milliseconds(90));
    EXPECT_EQ(live.passed_over_by_end(), 0U);
    // Three times the motion's own acceleration, 2.5, where no limit is given.
    const double most = limit > 0 ? limit : 7.5;
    EXPECT_LE(largest_acceleration(slowed), std::max(most, live.path_acceleration()) * (1 + 1e-9));
    const bool is_near = GetParam()->smooths() || GetParam()->laws.continuity < 2;
    EXPECT_LE(largest_error(slowed), is_near ? 2e-4 : 1e-6);
    EXPECT_EQ(live.verified(), "");
  }
}

INSTANTIATE_TEST_SUITE_P(Streaming, SlowedEndOfMethods,
                         ::testing::ValuesIn(testing::streaming_methods()),
                         [](const auto& at) { return std::string(at.param->name); });

TEST(SlowedEnd, UnwrapsPeriodicValues) {
  const std::vector<Dimension> periodic(2, {.kind = DimensionKind::periodic, .period = 0.05});
  OnCircle live(limited(c2(), 5), DimensionKinds(periodic));
  live.run(2000, 500);
  ASSERT_EQ(live.solver.summary().ending(), EndKind::slowed);
  EXPECT_LE(largest_acceleration(live.slowed()), 5 * (1 + 1e-9));
  EXPECT_EQ(live.verified(), "");
}

TEST(SlowedEnd, BeginsOnlyAtAWaypointThatHasNotSettled) {
  // To rest within the limit the curve needs 80 ms of its path.
  for (const int lead : {20, 40, 60, 80, 100, 300}) {
    SCOPED_TRACE(lead);
    OnCircle live(limited(c2(), 5));
    live.run(2000, lead);
    const EndKind end = live.solver.summary().ending();
    EXPECT_EQ(end == EndKind::slowed, lead >= 100) << static_cast<int>(end);
    EXPECT_EQ(live.verified(), "");
  }
}

TEST(SlowedEnd, StaysNearThePathIfWaypointsAreFarApart) {
  int slowed = 0;
  for (const int period : {50, 100, 150, 200, 300, 400}) {
    SCOPED_TRACE(period);
    OnCircle live(limited(c2(), 5), {}, period);
    live.run(4000, 3000);
    EXPECT_EQ(live.verified(), "");
    if (live.solver.summary().ending() != EndKind::slowed) continue;
    ++slowed;
    // At its end the spline is farther from the circle than before.
    EXPECT_LE(largest_error(live.slowed()), 4 * live.path_error() + 0.02 * kRadius);
  }
  EXPECT_GE(slowed, 4);
}

}  // namespace
}  // namespace splinecast::ipc
