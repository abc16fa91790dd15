#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "apps/record/output/states.hpp"
#include "apps/record/watch/returns.hpp"
#include "apps/record/watch/settled_excesses.hpp"
#include "ipc/options/stream.hpp"

/// What a recorder makes of settled segments: states, returns, outcomes of excesses.
namespace splinecast::apps::record {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using Outcome = SettledExcess::Outcome;

/// A segment of one dimension that moves with a constant velocity.
ipc::SegmentCopy a_segment(SegmentKind kind, Time left, Time right, double velocity = 0) {
  return {.number = 7,
          .next = 8,
          .left = left,
          .right = right,
          .natural_right = right,
          .order = 2,
          .kind = kind,
          .coefficients = {0, velocity}};
}

ipc::SegmentCopy to_waypoint(ipc::SegmentCopy segment) {
  segment.origin.ends_at_waypoint = true;
  return segment;
}

std::vector<Time> sampled(States& states, const ipc::SegmentCopy& segment) {
  std::vector<Time> times;
  states.sample(segment, [&](Time time, const State& state) {
    EXPECT_EQ(state.position()[0], segment.coefficients[1] * to_seconds(time - segment.left));
    times.push_back(time);
  });
  return times;
}

TEST(RecordStates, AreAtTheMultiplesOfTheIntervalWithinTheSegment) {
  const auto header = ipc::make_header({.dimensions = 1, .clock = StreamClock::recorded}, 77);
  States states(header, {.hz = 100, .most = 1000});
  EXPECT_EQ(
      sampled(states, a_segment(SegmentKind::spline, milliseconds(-15), milliseconds(20), 0.5)),
      (std::vector<Time>{milliseconds(-10), milliseconds(0), milliseconds(10)}));
  EXPECT_TRUE(
      sampled(states, a_segment(SegmentKind::spline, milliseconds(1), milliseconds(9))).empty());
}

TEST(RecordStates, OfALongSegmentAreAtAMultipleOfTheInterval) {
  const auto header = ipc::make_header({.dimensions = 1, .clock = StreamClock::recorded}, 77);
  States states(header, {.hz = 100, .most = 1000});
  const auto times = sampled(states, a_segment(SegmentKind::hold, milliseconds(3), hours(12)));
  EXPECT_LE(times.size(), 1000U);
  EXPECT_GT(times.size(), 990U);
  for (const Time time : times) EXPECT_EQ(time % milliseconds(10), Time::zero());
  EXPECT_LT(hours(12) - times.back(), Time(hours(12)) / 990);
}

TEST(RecordReturns, AReturnIsTheFirstWaypointAfterAStopOrAReplacement) {
  Returns returns;
  const auto spline = to_waypoint(a_segment(SegmentKind::spline, Time(0), Time(10)));
  EXPECT_FALSE(returns.take(nullptr, spline));
  const auto stop = a_segment(SegmentKind::stop, Time(10), Time(20));
  EXPECT_FALSE(returns.take(&spline, stop));
  const auto hold = a_segment(SegmentKind::hold, Time(20), Time(50));
  EXPECT_FALSE(returns.take(&stop, hold));
  const auto ahead = a_segment(SegmentKind::entry, Time(50), Time(60));  // onto no waypoint
  EXPECT_FALSE(returns.take(&hold, ahead));
  auto cut = to_waypoint(a_segment(SegmentKind::entry, Time(60), Time(65)));
  cut.natural_right = Time(70);  // replaced before it reaches its waypoint
  EXPECT_FALSE(returns.take(&ahead, cut));
  auto entry = to_waypoint(a_segment(SegmentKind::entry, Time(65), Time(80)));
  entry.origin.item = 12;
  const auto found = returns.take(&cut, entry);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->time, Time(80));
  EXPECT_EQ(found->away, Time(70));
  EXPECT_EQ(found->run_item, 12U);
  EXPECT_FALSE(returns.take(&entry, spline));
  const auto again = returns.take(&spline, entry);  // a replacement
  ASSERT_TRUE(again);
  EXPECT_EQ(again->away, Time(15));
}

TEST(RecordReturns, TheStartOfAStreamIsNotAReturnAndAnUnknownBeginHasNoTime) {
  auto first = to_waypoint(a_segment(SegmentKind::entry, Time(0), Time(10)));
  first.number = 1;
  EXPECT_FALSE(Returns().take(nullptr, first));
  Returns attached;
  const auto hold = a_segment(SegmentKind::hold, Time(0), Time(10));
  EXPECT_FALSE(attached.take(nullptr, hold));
  const auto found =
      attached.take(&hold, to_waypoint(a_segment(SegmentKind::entry, Time(10), Time(20))));
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->away);
}

class RecordExcesses : public ::testing::Test {
 protected:
  [[nodiscard]] static LimitExcess excess_at(Time time) {
    return {.item = 3,
            .kind = LimitKind::velocity,
            .dimension = 0,
            .time = time,
            .value = 2,
            .limit = 1};
  }
  SettledExcesses excesses{{.limits = {.velocity = {1}}}, {}};
};

TEST_F(RecordExcesses, AnExcessIsExecutedIfTheSettledSegmentHasIt) {
  EXPECT_FALSE(excesses.add(excess_at(milliseconds(15))));
  EXPECT_FALSE(excesses.add(excess_at(milliseconds(25))));
  const auto part = [](int from, double velocity) {
    return a_segment(SegmentKind::spline, milliseconds(from), milliseconds(from + 10), velocity);
  };
  EXPECT_TRUE(excesses.take(part(0, 5)).empty());
  const auto executed = excesses.take(part(10, -1.5));
  ASSERT_EQ(executed.size(), 1U);
  EXPECT_EQ(executed[0].outcome, Outcome::executed);
  EXPECT_EQ(executed[0].excess.value, -1.5);
  EXPECT_EQ(executed[0].excess.item, 3U);
  const auto replaced = excesses.take(part(20, 0.5));
  ASSERT_EQ(replaced.size(), 1U);
  EXPECT_EQ(replaced[0].outcome, Outcome::replaced);
  EXPECT_TRUE(excesses.finish().empty());
}

TEST_F(RecordExcesses, AnExcessAtAKnotMayBeOfEitherSegment) {
  const auto part = [](int from, double velocity) {
    return a_segment(SegmentKind::spline, milliseconds(from), milliseconds(from + 10), velocity);
  };
  for (const auto& [before, after] : {std::pair{2.0, 0.0}, {0.0, 2.0}, {0.0, 0.0}}) {
    EXPECT_FALSE(excesses.add(excess_at(milliseconds(10))));
    auto found = excesses.take(part(0, before));
    EXPECT_EQ(found.size(), before > 1 ? 1U : 0U);
    const auto further = excesses.take(part(10, after));
    found.insert(found.end(), further.begin(), further.end());
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].outcome, before + after > 1 ? Outcome::executed : Outcome::replaced);
  }
}

TEST_F(RecordExcesses, WithoutItsSegmentTheOutcomeIsUnknown) {
  EXPECT_FALSE(excesses.add(excess_at(milliseconds(5))));
  const auto later = a_segment(SegmentKind::spline, milliseconds(10), milliseconds(20), 2);
  const auto lost = excesses.take(later);
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_EQ(lost[0].outcome, Outcome::unknown);
  std::optional<SettledExcess> dropped;
  std::int64_t count = 0;
  for (; !dropped && count < 10'000; ++count) dropped = excesses.add(excess_at(Time(count)));
  ASSERT_TRUE(dropped);
  EXPECT_EQ(dropped->outcome, Outcome::unknown);
  const auto rest = excesses.finish();  // the curve has ended before all of them
  EXPECT_EQ(rest.size(), static_cast<std::size_t>(count - 1));
  EXPECT_TRUE(std::ranges::all_of(
      rest, [](const SettledExcess& excess) { return excess.outcome == Outcome::replaced; }));
}

}  // namespace
}  // namespace splinecast::apps::record
