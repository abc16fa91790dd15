#include "core/online/entry_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "tests/fixtures/curves/mesh.hpp"

namespace splinecast::core {
namespace {

using std::chrono::milliseconds;
using Outcome = EntrySearch::Outcome;

constexpr int kAny = 1000;

/// A state with values of its own.
struct From {
  Time time{};
  std::vector<double> position, velocity, acceleration;

  [[nodiscard]] Instant instant() const { return {time, position, velocity, acceleration}; }
};

From at_rest(Time t, std::vector<double> x) {
  const std::size_t n = x.size();
  return {t, std::move(x), std::vector<double>(n), std::vector<double>(n)};
}

using Motion = std::function<double(double, std::size_t)>;

double sine(double s, std::size_t d) { return std::sin(s + static_cast<double>(d)); }

/// A target with knots every `step` from 100 ms on.
SlidingWindow target_of(std::size_t dimensions, const Motion& motion, int knots,
                        const MotionLimits& limits = {}, Time step = milliseconds(20)) {
  WindowOptions how{.limits = limits};
  SlidingWindow window(dimensions, how);
  window.begin_run();
  std::vector<double> x(dimensions);
  for (int i = 0; i < knots; ++i) {
    const Time t = milliseconds(100) + i * step;
    for (std::size_t d = 0; d < dimensions; ++d) x[d] = motion(to_seconds(t), d);
    window.append({.time = t, .position = x});
  }
  return window;
}

/// All that one search finds, however few candidates it may try at once.
struct Found {
  Outcome outcome = Outcome::more;
  EntryEnd end;
  Segment entry;
  int tried = 0;
};

Found look_for(EntrySearch& search, const SlidingWindow& target, const From& from,
               const EntryRules& rules, int at_once = kAny,
               std::optional<Time> former_end = std::nullopt) {
  Found found{.end = {}, .entry = Segment(target.dimensions())};
  if (former_end) {
    search.restart(0, from.instant(),
                   {*former_end, from.position, from.velocity, from.acceleration});
  } else {
    search.restart(0);
  }
  for (int i = 0; i < kAny && found.outcome == Outcome::more; ++i) {
    int tries = at_once;
    found.outcome = search.search(target, from.instant(), rules, tries);
    EXPECT_GE(tries, 0);
    EXPECT_LE(tries, at_once);
    found.tried += at_once - tries;
  }
  found.end = search.end();
  found.entry = search.entry();
  return found;
}

/// The peak of one derivative of a segment's dimension, sampled.
double peak(const Segment& segment, std::size_t dimensions, std::size_t d, int derivative) {
  State state(dimensions);
  const double h = to_seconds(segment.right - segment.left);
  double most = 0;
  for (int i = 0; i <= 2000; ++i) {
    evaluate(segment.order, segment.coefficients, h * i / 2000, state.ref());
    const std::array all{state.position(), state.velocity(), state.acceleration(), state.jerk()};
    most = std::max(most, std::abs(all[static_cast<std::size_t>(derivative)][d]));
  }
  return most;
}

/// The quintic from a state to the target's at a knot.
Segment quintic_to(const SlidingWindow& target, const From& from, std::size_t knot) {
  const Knot at = target.knot(knot);
  std::vector<double> acceleration(target.dimensions());
  target.write_acceleration(knot, acceleration);
  Segment out(target.dimensions());
  build_splice(from.instant(), {at.time, at.position, at.velocity, acceleration}, out);
  return out;
}

void expect_leads(const Segment& entry, const From& from, const Instant& to) {
  State state(from.position.size());
  EXPECT_EQ(entry.kind, SegmentKind::splice);
  EXPECT_EQ(entry.left, from.time);
  EXPECT_EQ(entry.right, to.time);
  evaluate(entry.order, entry.coefficients, 0, state.ref());
  EXPECT_TRUE(std::ranges::equal(state.position(), from.position));
  EXPECT_TRUE(std::ranges::equal(state.velocity(), from.velocity));
  EXPECT_TRUE(std::ranges::equal(state.acceleration(), from.acceleration));
  evaluate(entry.order, entry.coefficients, to_seconds(entry.right - entry.left), state.ref());
  for (std::size_t d = 0; d < from.position.size(); ++d) {
    EXPECT_NEAR(state.position()[d], to.position[d], 1e-9);
    EXPECT_NEAR(state.velocity()[d], to.velocity[d], 1e-8);
    EXPECT_NEAR(state.acceleration()[d], to.acceleration[d], 1e-6);
  }
}

TEST(EntrySearch, TakesTheFirstKnotThatTheLimitsAllow) {
  const MotionLimits limits{.velocity = {4}, .acceleration = {20}};
  SlidingWindow target = target_of(1, sine, 10, limits);
  int later = 0;
  for (int i = 0; i < 40; ++i) {
    const From from = at_rest(milliseconds(50), {sine(0.05, 0) + 0.01 * (i - 20)});
    EntrySearch search(1, {});
    const Found found = look_for(search, target, from, {.limits = &limits, .goes_beyond = true});
    ASSERT_EQ(found.outcome, Outcome::found) << i;
    // The newest one counts as beyond.
    const std::size_t end = found.end.knot.value_or(target.knots() - 1);
    for (std::size_t k = 0; k < end; ++k) {
      EXPECT_FALSE(keeps_within(limits, nullptr, quintic_to(target, from, k))) << i << ' ' << k;
    }
    later += end > 0 ? 1 : 0;
    EXPECT_EQ(found.end.known, target.knots());
    expect_leads(found.entry, from, found.end.state);
    if (!found.end.knot) continue;
    EXPECT_TRUE(keeps_within(limits, nullptr, found.entry)) << i;
    EXPECT_EQ(found.entry.coefficients, quintic_to(target, from, end).coefficients);
    EXPECT_EQ(found.end.state.time, target.time(end));
  }
  EXPECT_GT(later, 20);
}

TEST(EntrySearch, PassesOverKnotsThatAreNearerThanTheShortestEntry) {
  const MotionLimits none;
  SlidingWindow target = target_of(1, sine, 10);
  const From from = at_rest(milliseconds(90), {sine(0.09, 0)});
  EntrySearch search(1, {});
  for (const auto& [least, knot] : std::vector<std::pair<int, std::size_t>>{
           {0, 0}, {10, 0}, {11, 1}, {30, 1}, {31, 2}, {110, 5}}) {
    const Found found =
        look_for(search, target, from, {.limits = &none, .least = milliseconds(least)});
    ASSERT_EQ(found.outcome, Outcome::found) << least;
    EXPECT_EQ(found.end.knot, knot) << least;
  }
}

/// What an entry may have that begins beyond a limit: as much as it begins with.
TEST(EntrySearch, FindsEntriesThatKeepEveryLimitFromRandomStates) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  const MotionLimits limits{.velocity = {1.5, 3},
                            .acceleration = {6, 12},
                            .jerk = {200, 900},
                            .lower = {-1.2, -1.4},
                            .upper = {1.2, 1.4}};
  int knots = 0;
  int beyond = 0;
  for (int i = 0; i < 300; ++i) {
    SlidingWindow target = target_of(2, sine, 3 + i % 8, limits, milliseconds(15 + i % 30));
    const double off = i % 3 == 0 ? 0.1 : 0.002;
    From from = at_rest(milliseconds(60), {0, 0});
    for (std::size_t d = 0; d < 2; ++d) {
      const double phase = 0.06 + static_cast<double>(d);
      from.position[d] = std::sin(phase) + off * unit(random);
      from.velocity[d] = std::cos(phase) + 5 * off * unit(random);
      from.acceleration[d] = i % 3 == 0 ? 8 * unit(random) : -std::sin(phase);
    }
    EntrySearch search(2, {});
    const Found found = look_for(search, target, from, {.limits = &limits, .goes_beyond = true});
    if (found.outcome == Outcome::none) continue;
    ++(found.end.knot ? knots : beyond);
    expect_leads(found.entry, from, found.end.state);
    for (std::size_t d = 0; d < 2; ++d) {
      const double v = std::max(limits.velocity[d], std::abs(from.velocity[d]));
      const double a = std::max(limits.acceleration[d], std::abs(from.acceleration[d]));
      EXPECT_LE(peak(found.entry, 2, d, 0), limits.upper[d] * (1 + 1e-9)) << i;
      EXPECT_LE(peak(found.entry, 2, d, 1), v * (1 + 1e-9)) << i;
      EXPECT_LE(peak(found.entry, 2, d, 2), a * (1 + 1e-9)) << i;
      EXPECT_LE(peak(found.entry, 2, d, 3), limits.jerk[d] * (1 + 1e-9)) << i;
    }
  }
  EXPECT_GT(knots, 20);
  EXPECT_GT(beyond, 20);
}

TEST(EntrySearch, GoesBeyondTheNewestKnotOntoItsExtrapolationWhereNoKnotPasses) {
  const MotionLimits limits{.acceleration = {4}};
  SlidingWindow target = target_of(1, sine, 5, limits);
  const From from = at_rest(milliseconds(90), {sine(0.09, 0) - 0.5});
  EntrySearch search(1, {});
  const Found at_knots = look_for(search, target, from, {.limits = &limits});
  EXPECT_EQ(at_knots.outcome, Outcome::none);
  const Found found = look_for(search, target, from, {.limits = &limits, .goes_beyond = true});
  ASSERT_EQ(found.outcome, Outcome::found);
  EXPECT_FALSE(found.end.knot);
  EXPECT_EQ(found.end.known, 5U);
  EXPECT_GT(found.end.state.time, target.time(4));
  EXPECT_LE(found.end.state.time - from.time, EntrySearch::kLongest);
  Extrapolation extrapolation(1);
  extrapolation.begin(target);
  EXPECT_EQ(found.end.line_end, extrapolation.line_end());
  EXPECT_EQ(found.end.rest, extrapolation.rest());
  State at(1);
  extrapolation.state_at(found.end.state.time, at.ref());
  EXPECT_EQ(found.end.state.position[0], at.position()[0]);
  EXPECT_EQ(found.end.state.velocity[0], at.velocity()[0]);
  EXPECT_EQ(found.end.state.acceleration[0], at.acceleration()[0]);
  expect_leads(found.entry, from, found.end.state);
  EXPECT_LE(peak(found.entry, 1, 0, 2), 4 * (1 + 1e-9));
}

TEST(EntrySearch, FindsNothingWhereAnEntryOrItsStopLeavesItsBounds) {
  const MotionLimits limits{.acceleration = {4}, .lower = {-1}, .upper = {0.05}};
  SlidingWindow target = target_of(1, sine, 5, limits);  // which lies beyond the bounds
  const From from = at_rest(milliseconds(50), {0});
  EntrySearch search(1, {});
  const EntryRules rules{.limits = &limits, .goes_beyond = true};
  EXPECT_EQ(look_for(search, target, from, rules).outcome, Outcome::none);
  // Within them, but not where the stop behind it comes to rest.
  const MotionLimits near{.acceleration = {4}, .lower = {-1}, .upper = {0.3}};
  SlidingWindow moving = target_of(1, sine, 5, near);
  const EntryRules near_rules{.limits = &near, .goes_beyond = true};
  const From behind = at_rest(milliseconds(90), {sine(0.09, 0) - 0.2});
  EXPECT_EQ(look_for(search, moving, behind, near_rules).outcome, Outcome::none);
}

TEST(EntrySearch, FallsBackToTheFirstKnotThatItReachesWhereWhatLiesBehindItBreaksTheLimits) {
  // A jump at the end of the target, which is beyond the limits wherever it is entered.
  const Motion jumps = [](double s, std::size_t) { return s < 0.29 ? 0.1 * s : 5.0; };
  const MotionLimits limits{.acceleration = {10}};
  SlidingWindow target = target_of(1, jumps, 11, limits);
  const From from = at_rest(milliseconds(50), {0.005});
  EntrySearch search(1, {});
  const Found at_knots = look_for(search, target, from, {.limits = &limits});
  EXPECT_EQ(at_knots.outcome, Outcome::none);
  const Found found = look_for(search, target, from, {.limits = &limits, .goes_beyond = true});
  if (found.end.knot) {
    ASSERT_EQ(found.outcome, Outcome::found);
    EXPECT_TRUE(keeps_within(limits, nullptr, found.entry));
    for (std::size_t k = target.oldest_segment(); k < *found.end.knot; ++k) {
      EXPECT_FALSE(keeps_within(limits, nullptr, quintic_to(target, from, k))) << k;
    }
  } else {
    ADD_FAILURE() << "went beyond the jump";
  }
}

TEST(EntrySearch, PrefersALaterKnotBehindWhichTheTargetKeepsItsLimits) {
  // A hump at the beginning that is beyond the limits, and rest behind it.
  const Motion hump = [](double s, std::size_t) { return s > 0.13 && s < 0.15 ? 0.02 : 0.0; };
  const MotionLimits limits{.acceleration = {10}};
  SlidingWindow target = target_of(1, hump, 9, limits, milliseconds(40));
  const From from = at_rest(milliseconds(50), {0});
  EntrySearch search(1, {});
  const EntryRules rules{.limits = &limits, .goes_beyond = true};
  const Found found = look_for(search, target, from, rules);
  ASSERT_EQ(found.outcome, Outcome::found);
  Segment segment(1);
  for (std::size_t i = found.end.knot.value_or(8); i + 1 < target.knots(); ++i) {
    target.segment(i, segment);
    EXPECT_TRUE(keeps_within(limits, nullptr, segment)) << i;
  }
  target.segment(0, segment);
  EXPECT_FALSE(keeps_within(limits, nullptr, segment));
}

TEST(EntrySearch, TriesNoMoreCandidatesAtOnceThanItMayAndFindsTheSame) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 100; ++i) {
    const MotionLimits limits{.velocity = {1.5}, .acceleration = {3.0 + 10 * (i % 3)}};
    SlidingWindow target = target_of(1, sine, 3 + i % 8, limits);
    From from = at_rest(milliseconds(80), {sine(0.08, 0) + 0.3 * unit(random)});
    from.velocity[0] = unit(random);
    const EntryRules rules{.limits = &limits, .goes_beyond = true};
    EntrySearch search(1, {});
    const Found whole = look_for(search, target, from, rules);
    for (const int at_once : {1, 2, 4}) {
      const Found parts = look_for(search, target, from, rules, at_once);
      EXPECT_EQ(parts.outcome, whole.outcome) << i;
      EXPECT_EQ(parts.tried, whole.tried) << i;
      EXPECT_EQ(parts.end.knot, whole.end.knot) << i;
      if (whole.outcome != Outcome::found) continue;
      EXPECT_EQ(parts.end.state.time, whole.end.state.time) << i;
      EXPECT_EQ(parts.entry.coefficients, whole.entry.coefficients) << i;
    }
  }
}

TEST(EntrySearch, WithoutATryLeftTriesNothing) {
  const MotionLimits limits{.acceleration = {10}};
  SlidingWindow target = target_of(1, sine, 9, limits);
  const From from = at_rest(milliseconds(90), {sine(0.09, 0)});
  EntrySearch search(1, {});
  search.restart(0);
  int tries = 0;
  const EntryRules rules{.limits = &limits, .goes_beyond = true};
  EXPECT_EQ(search.search(target, from.instant(), rules, tries), Outcome::more);
  EXPECT_EQ(tries, 0);
}

TEST(EntrySearch, SpendsNoTryOnKnotsThatAreOutOfReach) {
  const MotionLimits limits{.acceleration = {1}};
  SlidingWindow target = target_of(1, sine, 9, limits);
  const From from = at_rest(milliseconds(90), {sine(0.09, 0) + 50});
  EntrySearch search(1, {});
  const Found found = look_for(search, target, from, {.limits = &limits});
  EXPECT_EQ(found.outcome, Outcome::none);
  EXPECT_EQ(found.tried, 0);
}

TEST(EntrySearch, TakesAKnotOnceAsManyNewerOnesAreKnownAsItMust) {
  const MotionLimits none;
  const EntryRules rules{.limits = &none, .newer = 8};
  SlidingWindow target(1, {});
  target.begin_run();
  const From from = at_rest(milliseconds(90), {sine(0.09, 0)});
  EntrySearch search(1, {});
  search.restart(0);
  for (int i = 0; i <= 8; ++i) {
    const double x = sine(0.1 + 0.02 * i, 0);
    target.append({.time = milliseconds(100 + 20 * i), .position = {&x, 1}});
    int tries = kAny;
    const Outcome outcome = search.search(target, from.instant(), rules, tries);
    EXPECT_EQ(outcome, i < 8 ? Outcome::none : Outcome::found) << i;
    EXPECT_EQ(tries, i < 8 ? kAny : kAny - 1) << i;
  }
  EXPECT_EQ(search.end().knot, 0U);
  EXPECT_EQ(search.end().known, 9U);
}

/// The durations beyond the newest knot of a target that is 0.5 away, and the first that passes.
class FormerEnd : public ::testing::Test {
 protected:
  [[nodiscard]] Found look(std::optional<Time> former_end, int at_once = kAny) {
    return look_for(search_, target_, from_, {.limits = &limits_, .goes_beyond = true}, at_once,
                    former_end);
  }
  [[nodiscard]] bool passes(Time end) {
    Extrapolation extrapolation(1);
    extrapolation.begin(target_);
    State at(1);
    extrapolation.state_at(end, at.ref());
    Segment quintic(1);
    build_splice(from_.instant(), {end, at.position(), at.velocity(), at.acceleration()}, quintic);
    return keeps_within(limits_, nullptr, quintic);
  }
  /// A time after the last duration that does not pass and before the first one that does, which
  /// passes or not.
  [[nodiscard]] Time between(bool passing) {
    const Time found = look(std::nullopt).end.state.time;
    const auto before = Time(
        std::llround(static_cast<double>((found - from_.time).count()) / EntrySearch::kGrowth));
    for (int i = 1; i < 100; ++i) {
      const Time end = from_.time + before + (found - from_.time - before) * i / 100;
      if (passes(end) == passing) return end;
    }
    ADD_FAILURE() << "there is none";
    return {};
  }

  const MotionLimits limits_{.acceleration = {4}};
  const SlidingWindow target_ = target_of(1, sine, 5, limits_);
  const From from_ = at_rest(milliseconds(90), {sine(0.09, 0) - 0.5});
  EntrySearch search_{1, {}};
};

TEST_F(FormerEnd, IsTakenAgainBeforeTheNextLongerDuration) {
  const Found anew = look(std::nullopt);
  ASSERT_EQ(anew.outcome, Outcome::found);
  ASSERT_FALSE(anew.end.knot);
  const Time former = between(true);
  ASSERT_LT(former, anew.end.state.time);
  for (const int at_once : {kAny, 4, 1}) {
    const Found found = look(former, at_once);
    ASSERT_EQ(found.outcome, Outcome::found);
    EXPECT_FALSE(found.end.knot);
    EXPECT_EQ(found.end.state.time, former);
    expect_leads(found.entry, from_, found.end.state);
  }
}

TEST_F(FormerEnd, ThatDoesNotPassIsTriedOnceAndDelaysTheSearchByNothingElse) {
  const Found anew = look(std::nullopt);
  const Found found = look(between(false));
  ASSERT_EQ(found.outcome, Outcome::found);
  // The next duration grows from the former end: it is no longer than the one that was found plus
  // one step.
  EXPECT_GT(found.end.state.time, anew.end.state.time);
  EXPECT_LE(found.end.state.time - from_.time,
            (anew.end.state.time - from_.time) * EntrySearch::kGrowth);
  EXPECT_LE(found.tried, anew.tried + 1);
}

TEST_F(FormerEnd, ThatLiesBeforeTheNewestKnotOrBehindAShorterDurationThatPassesIsNotTaken) {
  const Found anew = look(std::nullopt);
  for (const Time former :
       {from_.time - milliseconds(1), target_.time(2), target_.time(4),
        anew.end.state.time + milliseconds(1), anew.end.state.time + std::chrono::seconds(9)}) {
    const Found found = look(former);
    ASSERT_EQ(found.outcome, Outcome::found);
    EXPECT_EQ(found.end.state.time, anew.end.state.time) << former.count();
    EXPECT_EQ(found.tried, anew.tried) << former.count();
  }
}

TEST_F(FormerEnd, IsForgottenByTheNextRestart) {
  const Found anew = look(std::nullopt);
  const Time former = between(true);
  ASSERT_EQ(look(former).end.state.time, former);
  EXPECT_EQ(look(std::nullopt).end.state.time, anew.end.state.time);
}

TEST(EntrySearch, LooksOnlyAtNewKnotsUntilItIsRestarted) {
  const MotionLimits limits{.acceleration = {10}};
  SlidingWindow target = target_of(1, sine, 4, limits);
  const From from = at_rest(milliseconds(90), {sine(0.09, 0) - 0.5});
  EntrySearch search(1, {});
  const EntryRules rules{.limits = &limits};
  EXPECT_EQ(look_for(search, target, from, rules).outcome, Outcome::none);
  // A state from which it would reach the first knot, if it looked at it.
  From near = from;
  near.position[0] = sine(0.06, 0);
  near.velocity[0] = 1;
  near.time = milliseconds(60);
  int tries = kAny;
  EXPECT_EQ(search.search(target, near.instant(), rules, tries), Outcome::none);
  search.restart(0);
  EXPECT_EQ(search.search(target, near.instant(), rules, tries), Outcome::found);
  EXPECT_EQ(search.end().knot, 0U);
}

/// A turn about one axis: (cos φ/2, 0, 0, sin φ/2).
std::vector<double> turned(double half) { return {std::cos(half), 0, 0, std::sin(half)}; }

DimensionKinds quaternion() {
  const std::vector<Dimension> dimensions(4, {.kind = DimensionKind::quaternion, .period = 0});
  return DimensionKinds(dimensions);
}

/// Far away at first, where the straight way leads past zero, and near in the end.
TEST(EntrySearch, KeepsTheLengthOfAQuaternionAlongAnEntry) {
  const double pi = std::numbers::pi;
  const Motion turn = [pi](double s, std::size_t d) {
    return turned(0.95 * pi - (s - 0.1) / 0.18 * 0.75 * pi)[d];
  };
  const MotionLimits none;
  SlidingWindow target = target_of(4, turn, 10);
  const From from = at_rest(milliseconds(80), turned(0));
  const auto shortest = [](const Segment& entry) {
    State state(4);
    double least = 1;
    const double h = to_seconds(entry.right - entry.left);
    for (int i = 0; i <= 1000; ++i) {
      evaluate(entry.order, entry.coefficients, h * i / 1000, state.ref());
      double squares = 0;
      for (const double x : state.position()) squares += x * x;
      least = std::min(least, std::sqrt(squares));
    }
    return least;
  };
  EntrySearch search(4, quaternion());
  const Found found = look_for(search, target, from, {.limits = &none});
  ASSERT_EQ(found.outcome, Outcome::found);
  ASSERT_TRUE(found.end.knot);
  EXPECT_GT(*found.end.knot, 0U);
  EXPECT_GE(shortest(found.entry), 0.69);
  for (std::size_t k = 0; k < *found.end.knot; ++k) {
    EXPECT_LT(shortest(quintic_to(target, from, k)), 0.71) << k;
  }
  // Of four dimensions that are no rotation nothing is asked.
  EntrySearch linear(4, {});
  EXPECT_EQ(look_for(linear, target, from, {.limits = &none}).end.knot, 0U);
}

TEST(EntrySearch, WithoutLimitsStaysWithinWhatTheMotionHasShown) {
  const MotionLimits none;
  const MotionLimits shown{.velocity = {3}, .acceleration = {9}};
  SlidingWindow target = target_of(1, sine, 9);
  const From from = at_rest(milliseconds(90), {sine(0.09, 0) - 0.3});
  EntrySearch search(1, {});
  const Found any = look_for(search, target, from, {.limits = &none});
  ASSERT_EQ(any.outcome, Outcome::found);
  EXPECT_EQ(any.end.knot, 0U);
  EXPECT_GT(peak(any.entry, 1, 0, 2), 1000);
  const EntryRules rules{.limits = &none, .shown = &shown, .goes_beyond = true};
  const Found found = look_for(search, target, from, rules);
  ASSERT_EQ(found.outcome, Outcome::found);
  EXPECT_LE(peak(found.entry, 1, 0, 1), 3 * (1 + 1e-9));
  EXPECT_LE(peak(found.entry, 1, 0, 2), 9 * (1 + 1e-9));
}

TEST(EntrySearch, WithoutLimitsFindsAnEntryFromAnywhereInThreeSecondsAtMost) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-4, 4);
  std::uniform_real_distribution<double> unit(-1, 1);
  const MotionLimits none;
  const MotionLimits shown{.velocity = {0.1, 0}, .acceleration = {0.1, 0}};
  for (int i = 0; i < 200; ++i) {
    SlidingWindow target = target_of(2, sine, 1 + i % 10);
    From from = at_rest(milliseconds(80), {unit(random) * std::pow(10, exponent(random)),  //
                                           unit(random) * std::pow(10, exponent(random))});
    for (double& v : from.velocity) v = unit(random) * std::pow(10, exponent(random));
    EntrySearch search(2, {});
    const Found found =
        look_for(search, target, from, {.limits = &none, .shown = &shown, .goes_beyond = true}, 4);
    ASSERT_EQ(found.outcome, Outcome::found) << i;
    EXPECT_LE(found.end.state.time - from.time, EntrySearch::kLongest);
    EXPECT_LE(found.tried, 64);
    expect_leads(found.entry, from, found.end.state);
  }
}

TEST(EntrySearch, OfTheEndTakesItsOwnTimeIfTheLimitsAllow) {
  const MotionLimits limits{.acceleration = {10}};
  const From from = at_rest(milliseconds(100), {0});
  const From end = at_rest(milliseconds(600), {0.2});
  EntrySearch search(1, {});
  search.restart(0);
  int tries = kAny;
  ASSERT_EQ(search.search_rest(end.instant(), from.instant(), {.limits = &limits}, tries),
            Outcome::found);
  EXPECT_EQ(search.end().state.time, end.time);
  expect_leads(search.entry(), from, end.instant());
}

TEST(EntrySearch, OfTheEndIsAsLateAsTheLimitsAskForAndHardlyLater) {
  const MotionLimits limits{.acceleration = {10}};
  for (const double distance : {0.01, 0.2, 3.0, 1000.0}) {
    for (const int own : {-500, 0, 1, 30}) {  // it may have passed
      const From from = at_rest(milliseconds(100), {0});
      const From end = at_rest(milliseconds(100 + own), {distance});
      EntrySearch search(1, {});
      Outcome outcome = Outcome::more;
      search.restart(0);
      const EntryRules rules{.limits = &limits, .least = milliseconds(5)};
      for (int i = 0; i < kAny && outcome == Outcome::more; ++i) {
        int tries = 4;
        outcome = search.search_rest(end.instant(), from.instant(), rules, tries);
      }
      ASSERT_EQ(outcome, Outcome::found);
      const Segment& entry = search.entry();
      State state(1);
      const double length = to_seconds(entry.right - entry.left);
      evaluate(entry.order, entry.coefficients, length, state.ref());
      EXPECT_NEAR(state.position()[0], distance, 1e-9 * distance);
      EXPECT_LE(peak(entry, 1, 0, 2), 10 * (1 + 1e-9));
      // Rest to rest over x in T peaks at 10/√3 · x/T².
      const double least = std::sqrt(10 / std::sqrt(3.0) * distance / 10);
      EXPECT_GE(length, least * (1 - 1e-6));
      EXPECT_LE(length, least * EntrySearch::kGrowth * (1 + 1e-6)) << distance << ' ' << own;
    }
  }
}

/// Whether a stream may start at rest with the first `knots` waypoints of a motion.
bool keeps_start(const Motion& motion, int knots, Time step, const MotionLimits& limits,
                 const MotionLimits* shown) {
  WindowOptions how{.start = {.kind = ConditionKind::halt, .value = {}}, .limits = limits};
  SlidingWindow window(1, how);
  for (int i = 0; i < knots; ++i) {
    const double x = motion(to_seconds(i * step), 0);
    window.append({.time = i * step, .position = {&x, 1}});
  }
  EntrySearch search(1, {});
  return search.keeps_start(window, {.limits = &limits, .shown = shown});
}

double slow(double s, std::size_t /*d*/) { return 1 - std::cos(s); }
double sudden(double s, std::size_t /*d*/) { return s; }  // at once at velocity 1

TEST(EntrySearch, AllowsAStartWhoseSegmentsKeepTheLimits) {
  for (const int knots : {2, 3, 5, 8}) {
    const MotionLimits limits{.acceleration = {10}};
    EXPECT_TRUE(keeps_start(slow, knots, milliseconds(20), limits, nullptr)) << knots;
    EXPECT_FALSE(keeps_start(sudden, knots, milliseconds(20), limits, nullptr)) << knots;
    EXPECT_TRUE(keeps_start(sudden, knots, milliseconds(20), {}, nullptr)) << knots;
  }
}

TEST(EntrySearch, AllowsAStartWithoutALimitThatStaysWithinWhatTheMotionShows) {
  const MotionLimits shown{.velocity = {3}, .acceleration = {4}};
  for (const int knots : {2, 3, 4, 5, 8}) {
    EXPECT_TRUE(keeps_start(slow, knots, milliseconds(20), {}, &shown)) << knots;
    EXPECT_FALSE(keeps_start(sudden, knots, milliseconds(20), {}, &shown)) << knots;
  }
  // A given limit counts instead of what the motion shows.
  const MotionLimits wide{.acceleration = {10'000}};
  EXPECT_TRUE(keeps_start(sudden, 8, milliseconds(20), wide, &shown));
}

/// What a motion at 30 Hz shows by its first waypoints: three times the mean velocity, and the
/// acceleration of a stop from that velocity.
MotionLimits shown_at_30_hz(const Motion& motion, Time step) {
  const double mean =
      std::abs(motion(to_seconds(2 * step), 0) - motion(0, 0)) / to_seconds(2 * step);
  return {.velocity = {3 * mean}, .acceleration = {mean / to_seconds(WindowOptions().stop_time)}};
}

TEST(EntrySearch, AllowsNoStartInMidMotionOfWhichThreeWaypointsAreKnown) {
  const Time step{33'333'333};
  for (const double phase : {0.0, 0.3, 0.6, 2.5}) {
    const Motion moving = [phase](double s, std::size_t) { return std::sin(2 * s + phase); };
    const MotionLimits shown = shown_at_30_hz(moving, step);
    for (const int knots : {3, 4}) {
      EXPECT_FALSE(keeps_start(moving, knots, step, {}, &shown)) << phase << ' ' << knots;
    }
  }
}

TEST(EntrySearch, AllowsTheStartOfAMinimumJerkMotionOfWhichThreeWaypointsAreKnown) {
  const Time step{33'333'333};
  for (const double duration : {0.5, 1.0, 2.0, 5.0}) {
    const Motion min_jerk = [duration](double s, std::size_t) {
      const double u = s / duration;
      return u * u * u * (10 + u * (-15 + u * 6));
    };
    const MotionLimits shown = shown_at_30_hz(min_jerk, step);
    for (const int knots : {3, 4}) {
      EXPECT_TRUE(keeps_start(min_jerk, knots, step, {}, &shown)) << duration << ' ' << knots;
    }
  }
}

}  // namespace
}  // namespace splinecast::core
