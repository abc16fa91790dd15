#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <optional>

#include "tests/core/motion/entry_trial.hpp"

/// A restarted search reuses the end of its previous entry.
namespace splinecast::core::entries {
namespace {

using std::chrono::milliseconds;

/// A search onto a target that is 0.5 away, so that the entry ends after the newest knot.
class FormerEnd : public ::testing::Test {
 protected:
  [[nodiscard]] Found look(std::optional<Time> former_end, int at_once = kAny) {
    return look_for(search_, target_, from_, {.limits = &limits_, .may_end_ahead = true}, at_once,
                    former_end);
  }
  [[nodiscard]] bool passes(Time end) {
    Extrapolation extrapolation(1);
    extrapolation.begin(target_);
    State at(1);
    extrapolation.state_at(end, at.ref());
    Segment quintic(1);
    build_entry(from_.instant(), {end, at.position(), at.velocity(), at.acceleration()}, quintic);
    return keeps_within(limits_, nullptr, quintic);
  }
  /// A time between the end of the last candidate that exceeds the limits and the end of the first
  /// one that keeps them. `passing` selects whether an entry that ends at this time keeps the
  /// limits.
  [[nodiscard]] Time between(bool passing) {
    const Time found = look(std::nullopt).end.state.time;
    const auto before = Time(
        std::llround(static_cast<double>((found - from_.time).count()) / EntrySearch::kGrowth));
    for (int i = 1; i < 100; ++i) {
      const Time end = from_.time + before + (found - from_.time - before) * i / 100;
      if (passes(end) == passing) return end;
    }
    ADD_FAILURE() << "no such time exists";
    return {};
  }

  const MotionLimits limits_{.acceleration = {4}};
  const SlidingWindow target_ = target_of(1, sine, 5, limits_);
  const From from_ = at_rest(milliseconds(90), {sine(0.09, 0) - 0.5});
  EntrySearch search_{1, {}};
};

TEST_F(FormerEnd, IsTakenAgainBeforeTheNextLongerDuration) {
  const Found again = look(std::nullopt);
  ASSERT_EQ(again.outcome, Outcome::found);
  ASSERT_FALSE(again.end.knot);
  const Time former = between(true);
  ASSERT_LT(former, again.end.state.time);
  for (const int at_once : {kAny, 4, 1}) {
    const Found found = look(former, at_once);
    ASSERT_EQ(found.outcome, Outcome::found);
    EXPECT_FALSE(found.end.knot);
    EXPECT_EQ(found.end.state.time, former);
    expect_leads(found.entry, from_, found.end.state);
  }
}

TEST_F(FormerEnd, BeyondTheLimitsCostsOneTryAndDelaysTheEntryByAtMostOneGrowthStep) {
  const Found again = look(std::nullopt);
  const Found found = look(between(false));
  ASSERT_EQ(found.outcome, Outcome::found);
  // After the former end the search continues with a duration that is one growth step longer, so
  // the entry is at most one growth step longer than without a former end.
  EXPECT_GT(found.end.state.time, again.end.state.time);
  EXPECT_LE(found.end.state.time - from_.time,
            (again.end.state.time - from_.time) * EntrySearch::kGrowth);
  EXPECT_LE(found.tried, again.tried + 1);
}

TEST_F(FormerEnd, BeforeTheNewestKnotOrAfterAShorterDurationWithinTheLimitsIsNotTaken) {
  const Found again = look(std::nullopt);
  for (const Time former :
       {from_.time - milliseconds(1), target_.time(2), target_.time(4),
        again.end.state.time + milliseconds(1), again.end.state.time + std::chrono::seconds(9)}) {
    const Found found = look(former);
    ASSERT_EQ(found.outcome, Outcome::found);
    EXPECT_EQ(found.end.state.time, again.end.state.time) << former.count();
    EXPECT_EQ(found.tried, again.tried) << former.count();
  }
}

TEST_F(FormerEnd, IsForgottenByTheNextRestart) {
  const Found again = look(std::nullopt);
  const Time former = between(true);
  ASSERT_EQ(look(former).end.state.time, former);
  EXPECT_EQ(look(std::nullopt).end.state.time, again.end.state.time);
}

}  // namespace
}  // namespace splinecast::core::entries
