#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/motion/entry_search.hpp"

/// Shared by the tests of entries: states beside a target, targets, and searches from a state onto
/// a target.
namespace splinecast::core::entries {

using Outcome = EntrySearch::Outcome;

/// More tries than any search needs.
inline constexpr int kAny = 1000;

/// A state that owns its values.
struct From {
  Time time{};
  std::vector<double> position, velocity, acceleration;

  [[nodiscard]] Instant instant() const { return {time, position, velocity, acceleration}; }
};

/// At rest at a position.
inline From at_rest(Time t, std::vector<double> x) {
  const std::size_t n = x.size();
  return {t, std::move(x), std::vector<double>(n), std::vector<double>(n)};
}

/// The position of dimension d after s seconds.
using Motion = std::function<double(double, std::size_t)>;

/// A motion with velocities and accelerations of at most 1.
inline double sine(double s, std::size_t d) { return std::sin(s + static_cast<double>(d)); }

/// A target with a knot every `step`, the first one at 100 ms.
inline SlidingWindow target_of(std::size_t dimensions, const Motion& motion, int knots,
                               const MotionLimits& limits = {},
                               Time step = std::chrono::milliseconds(20)) {
  WindowOptions how{.limits = limits};
  SlidingWindow window(dimensions, how);
  window.begin_run();
  std::vector<double> x(dimensions);
  for (int i = 0; i < knots; ++i) {
    const Time t = std::chrono::milliseconds(100) + i * step;
    for (std::size_t d = 0; d < dimensions; ++d) x[d] = motion(to_seconds(t), d);
    window.append({.time = t, .position = x});
  }
  return window;
}

/// The result of one search, over all of its calls.
struct Found {
  Outcome outcome = Outcome::more;
  EntryEnd end;
  Segment entry;
  int tried = 0;
};

/// Restarts a search and runs it to its end with at most `at_once` tries per call. `former_end`:
/// when the previous entry ended, if there was one.
inline Found look_for(EntrySearch& search, const SlidingWindow& target, const From& from,
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
inline double peak(const Segment& segment, std::size_t dimensions, std::size_t d, int derivative) {
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

/// The quintic from a state to the target's state at a knot.
inline Segment quintic_to(const SlidingWindow& target, const From& from, std::size_t knot) {
  const Knot at = target.knot(knot);
  std::vector<double> acceleration(target.dimensions());
  target.write_acceleration(knot, acceleration);
  Segment out(target.dimensions());
  build_entry(from.instant(), {at.time, at.position, at.velocity, acceleration}, out);
  return out;
}

/// Expects an entry to join two states.
inline void expect_leads(const Segment& entry, const From& from, const Instant& to) {
  State state(from.position.size());
  EXPECT_EQ(entry.kind, SegmentKind::entry);
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

}  // namespace splinecast::core::entries
