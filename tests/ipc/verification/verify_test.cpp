#include "ipc/verification/verify.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ipc/verification/settled_segments.hpp"
#include "tests/fixtures/curves/method_trial.hpp"
#include "tests/fixtures/curves/streaming_methods.hpp"
#include "tests/fixtures/streams/live_world.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::ipc {
namespace {

using testing::MemoryStream;
using testing::Trial;

/// A recorded stream, played to its end, with its collected segments and items.
class Played {
 public:
  explicit Played(const core::WindowOptions& how, const Condition& end = {},
                  DimensionKinds kinds = {}, std::size_t knots = 150)
      : window_(how), kinds_(std::move(kinds)), end_(end), items_(2) {
    MemoryStream stream(2, window_, 64, 1024, {}, kinds_);
    const Trial trial = testing::random_trial(11, knots, 2, 5);
    SettledSegments settled(stream.board.reader);
    for (std::size_t i = 0; i < trial.mesh.size(); ++i) {
      items_.add(ItemKind::waypoint, trial.waypoints()[i]);
      stream.send(trial.waypoints()[i]);
      if (i % 3 == 0) stream.drain();
      if (i % 7 == 0) stream.replace_solver();
      settled.look();
    }
    stream.finish(end);
    settled.look();
    segments.assign(settled.segments().begin(), settled.segments().end());
    summary = settled.summary();
  }

  [[nodiscard]] Verification verify() const { return verify(items_); }
  [[nodiscard]] Verification verify(const SentItems& items) const {
    return ipc::verify({.window = window_,
                        .kinds = kinds_,
                        .items = items,
                        .segments = segments,
                        .summary = summary,
                        .end = end_});
  }
  [[nodiscard]] const SentItems& items() const { return items_; }

  std::vector<SegmentCopy> segments;
  Summary summary;

 private:
  core::WindowOptions window_;
  DimensionKinds kinds_;
  Condition end_;
  SentItems items_;
};

std::string what(const Verification& found) {
  if (!found.first) return "";
  return std::to_string(found.first->segment) + ": " + found.first->what + ", " +
         found.first->published + " published, " + found.first->solved + " solved";
}

void flip_last_bit(double& value) {
  value = std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) ^ 1U);
}

class VerificationOfMethods : public ::testing::TestWithParam<const Method*> {};

TEST_P(VerificationOfMethods, ReproducesEverySettledSegmentBitForBit) {
  for (const ConditionKind kind : {ConditionKind::own, ConditionKind::halt}) {
    for (const std::size_t knots : {1U, 2U, 3U, 150U}) {
      core::WindowOptions how = testing::plain_window(*GetParam());
      how.start = {kind, {}};
      const Played played(how, {kind, {}}, {}, knots);
      const Verification found = played.verify();
      EXPECT_EQ(what(found), "");
      EXPECT_EQ(found.equal, knots == 1 ? 1 : knots - 1);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Streaming, VerificationOfMethods,
                         ::testing::ValuesIn(testing::streaming_methods()),
                         [](const auto& at) { return std::string(at.param->name); });

TEST(Verification, HandlesPeriodicDimensionsAndShortSettleLags) {
  const std::vector<Dimension> kinds{{.kind = DimensionKind::periodic, .period = 0.7}, {}};
  for (const std::size_t settle : {0U, 1U, 8U}) {
    EXPECT_EQ(what(Played({.settle = settle}, {}, DimensionKinds(kinds)).verify()), "");
  }
}

TEST(Verification, FindsOneFlippedBit) {
  const Played played(core::WindowOptions{});
  for (const std::size_t i : {0U, 70U, 148U}) {
    Played flipped = played;
    flip_last_bit(flipped.segments[i].coefficients[5]);
    const Verification found = flipped.verify();
    ASSERT_TRUE(found.first);
    EXPECT_EQ(found.equal, i);
    EXPECT_EQ(found.first->segment, i + 1);
    EXPECT_EQ(found.first->what, "coefficient 2 of dimension 1");
    EXPECT_NE(found.first->published, found.first->solved);
  }
}

TEST(Verification, FindsAnyOtherDifference) {
  const Played played(core::WindowOptions{});
  const auto found = [&](const auto& change) {
    Played changed = played;
    change(changed.segments[40]);
    const Verification verified = changed.verify();
    return verified.first ? verified.first->what : std::string();
  };
  EXPECT_EQ(found([](SegmentCopy& at) { flip_last_bit(at.waypoint[1]); }), "waypoint");
  EXPECT_EQ(found([](SegmentCopy& at) { at.right += Time(1); }), "right end");
  EXPECT_EQ(found([](SegmentCopy& at) { at.kind = SegmentKind::stop; }), "kind");
  EXPECT_EQ(found([](SegmentCopy& at) { at.acceleration_step[1] += 1e-3; }), "acceleration step");
  EXPECT_EQ(found([](SegmentCopy& at) { at.acceleration_step[1] *= -1; }), "acceleration step");
  EXPECT_EQ(found([](SegmentCopy& at) { at.acceleration_step.clear(); }), "acceleration step");
  EXPECT_NE(found([](SegmentCopy& at) { at.newer_knots = 3; }), "");
  EXPECT_NE(found([](SegmentCopy& at) { at.newer_knots = 4'000'000'000; }), "");
  EXPECT_NE(found([](SegmentCopy& at) { at.number = 7; }), "");
}

TEST(Verification, ReportsAWaypointThatIsNotOnTheCurve) {
  const Played played(core::WindowOptions{});
  SentItems more = played.items();
  more.add(ItemKind::waypoint, played.items().waypoint(more.size() - 1));
  const Verification found = played.verify(more);
  ASSERT_TRUE(found.first);
  EXPECT_EQ(found.first->what, "waypoint of item 150");
  more.refuse(150);
  EXPECT_FALSE(played.verify(more).first);
  SentItems fewer = played.items();
  fewer.refuse(100);
  EXPECT_TRUE(played.verify(fewer).first);
}

/// The hold would stop a moving machine at once.
TEST(Verification, FindsAHoldThatCutsAMotion) {
  Played stopped(core::WindowOptions{});
  stopped.segments.resize(41);
  SegmentCopy& cut = stopped.segments.back();
  cut.right = cut.left + (cut.right - cut.left) / 2;
  State state(2);
  core::evaluate(cut.order, cut.coefficients, to_seconds(cut.right - cut.left), state.ref());
  core::Segment held(2);
  core::build_hold(cut.right, cut.right, state.position(), held);
  SegmentCopy hold{.number = cut.next, .next = cut.next + 1};
  hold.left = hold.right = hold.natural_right = cut.right;
  hold.order = held.order;
  hold.kind = held.kind;
  hold.coefficients.assign(held.coefficients.begin(), held.coefficients.begin() + 2L * held.order);
  stopped.segments.push_back(hold);
  stopped.summary = {};
  const Verification found = stopped.verify();
  ASSERT_TRUE(found.first);
  EXPECT_EQ(found.first->what, "left end");
}

/// A record of another party may begin in any way.
TEST(Verification, ReportsAFirstSegmentThatIsAHoldOrAShortEntry) {
  for (const auto& [kind, order] : {std::pair{SegmentKind::hold, 1}, {SegmentKind::entry, 1}}) {
    Played strange(core::WindowOptions{});
    SegmentCopy& first = strange.segments.front();
    first.kind = kind;
    first.order = order;
    first.has_waypoint = false;
    first.waypoint.clear();
    first.coefficients.resize(2);
    first.origin.item = kind == SegmentKind::entry ? std::optional<Word>(0) : std::nullopt;
    first.origin.ends_at_waypoint = true;
    EXPECT_TRUE(strange.verify().first) << static_cast<int>(kind);
  }
}

TEST(Verification, ReportsAMissedWaypointAfterAReplacementOfOlderOnes) {
  const Played played(core::WindowOptions{});
  SentItems more = played.items();
  const Waypoint last = played.items().waypoint(more.size() - 1);
  more.add(ItemKind::waypoint, last);  // withdrawn by what follows
  more.add(ItemKind::replace, {.time = last.time});
  EXPECT_FALSE(played.verify(more).first);
  more.add(ItemKind::waypoint, last);
  const Verification found = played.verify(more);
  ASSERT_TRUE(found.first);
  EXPECT_EQ(found.first->what, "waypoint of item 152");
}

/// Kills, starvation and replacements, with local methods, with smoothing, with and without limits.
TEST(Verification, HoldsInLiveWorldsOfOtherMethods) {
  for (const char* name : {"c2", "akima", "pchip", "bessel", "smoothing"}) {
    core::WindowOptions window = testing::plain_window(*find_method(name));
    window.interpolant.lambda = name == std::string("smoothing") ? 1e-9 : 0;
    for (std::uint64_t seed = 1; seed <= 40 && !::testing::Test::HasFailure(); ++seed) {
      testing::LiveWorld world({.seed = seed,
                                .dimensions = 1 + seed % 3,
                                .window = window,
                                .starts_in_motion = seed % 2 == 0,
                                .starvations = 1,
                                .replacements = 3,
                                .solver_kills = 2,
                                .producer_kills = 2,
                                .pauses = 2,
                                .has_limits = seed % 4 < 2});
      world.run(std::chrono::milliseconds(1500));
      const Verification found = world.verify();
      EXPECT_EQ(what(found), "") << name << ", seed " << seed;
      EXPECT_GT(found.equal, 0U) << name << ", seed " << seed;
    }
  }
}

}  // namespace
}  // namespace splinecast::ipc
