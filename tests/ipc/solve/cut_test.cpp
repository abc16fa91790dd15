#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "ipc/sampling/snapshot.hpp"
#include "tests/fixtures/streams/live_stream.hpp"

/// A replacement cuts a published segment: the part before the cut keeps its bits, its kind and the
/// time at which it would have ended.
namespace splinecast::ipc {
namespace {

using core::SegmentForm;
using std::chrono::milliseconds;
using Live = testing::LiveStream;

Time at(int ms) { return Live::kNow + milliseconds(ms); }

/// All segments on the board.
std::vector<SegmentCopy> segments_of(Live& live) {
  BoardSnapshot snapshot(1);
  KnotCopy knot(1, live.board.reader.smooths());
  const Summary& summary = live.solver.summary();
  EXPECT_TRUE(live.board.reader.copy_knot(summary.first, summary.revision, knot));
  EXPECT_TRUE(has_values(live.sampler.snapshot(knot.time, Time::max(), snapshot)));
  return {snapshot.segments().begin(), snapshot.segments().end()};
}

/// Expects each packed time to be the start of its knot's segment. A knot without a segment is
/// neither the first one nor next to another one.
void expect_times_in_order(Live& live) {
  const Summary& summary = live.solver.summary();
  const KnotBoardReader& board = live.board.reader;
  bool was_none = true;
  for (Word n = summary.first; n <= summary.newest; ++n) {
    Time begins{};
    SegmentForm form{};
    ASSERT_TRUE(board.copy_time(n, summary.revision, begins, form));
    const bool is_none = form == SegmentForm::none;
    if (is_none && n < summary.newest) {
      EXPECT_FALSE(was_none) << n;
      ASSERT_TRUE(board.copy_time(n + 1, summary.revision, begins, form));
    }
    EXPECT_EQ(board.time_hint(n), begins) << n;
    if (n > summary.first) {
      EXPECT_LE(board.time_hint(n - 1), board.time_hint(n)) << n;
    }
    was_none = is_none;
  }
}

/// Expects the segments before a cut at t to be unchanged, except that the last one ends at t.
void expect_kept(const std::vector<SegmentCopy>& before, const std::vector<SegmentCopy>& after,
                 Time t) {
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(after[i].number, before[i].number);
    EXPECT_EQ(after[i].left, before[i].left);
    EXPECT_EQ(after[i].right, std::min(before[i].right, t));
    EXPECT_EQ(after[i].kind, before[i].kind);
    EXPECT_EQ(after[i].order, before[i].order);
    EXPECT_EQ(after[i].coefficients, before[i].coefficients);
    EXPECT_EQ(after[i].has_waypoint, before[i].has_waypoint);
    EXPECT_EQ(after[i].waypoint, before[i].waypoint);
    if (i > 0 || before[i].number == 1) {  // otherwise the board may have lost the previous segment
      EXPECT_EQ(after[i].acceleration_step, before[i].acceleration_step);
    }
    EXPECT_EQ(after[i].newer_knots, before[i].newer_knots);
    if (after[i].kind != SegmentKind::hold) {
      EXPECT_EQ(after[i].natural_right, before[i].natural_right);
    }
  }
}

/// Expects position and velocity to be continuous everywhere, also at the cut.
void expect_no_gap(const std::vector<SegmentCopy>& after) {
  State left(1);
  State right(1);
  for (std::size_t k = 1; k < after.size(); ++k) {
    EXPECT_EQ(after[k].left, after[k - 1].right);
    EXPECT_EQ(after[k].number, after[k - 1].next);
    const double length = to_seconds(after[k].left - after[k - 1].left);
    core::evaluate(after[k - 1].order, after[k - 1].coefficients, length, left.ref());
    core::evaluate(after[k].order, after[k].coefficients, 0, right.ref());
    EXPECT_NEAR(left.position()[0], right.position()[0], 1e-12);
    EXPECT_NEAR(left.velocity()[0], right.velocity()[0], 1e-9);
  }
}

/// Cuts the curve at t and expects that nothing before t changes, except that the last segment ends
/// at t.
void cut(Live& live, Time t, int waypoints = 3) {
  SCOPED_TRACE(::testing::Message() << "cut at " << to_seconds(t - Live::kNow) << " s");
  auto before = segments_of(live);
  std::vector<Time> times;
  for (int i = 1; i <= waypoints; ++i) times.push_back(t + i * milliseconds(10));
  ASSERT_EQ(live.replace(t, times), AppendStatus::accepted);
  live.drain();
  EXPECT_EQ(live.solver.summary().refused, 0U);
  EXPECT_EQ(live.solver.summary().changed_from, t);
  const auto after = segments_of(live);
  expect_times_in_order(live);
  std::erase_if(before, [&](const SegmentCopy& old) {
    return old.left >= t || old.number < live.solver.summary().first;
  });
  ASSERT_FALSE(before.empty());
  ASSERT_LT(before.size(), after.size());
  expect_kept(before, after, t);
  expect_no_gap(after);
}

/// The segment that contains t.
SegmentCopy segment_at(Live& live, Time t) {
  for (const SegmentCopy& segment : segments_of(live)) {
    if (segment.left <= t && t < segment.right) return segment;
  }
  ADD_FAILURE() << "no segment";
  return {};
}

/// Whether the segment that contains t is an entry or, if no entry is found yet, a stop segment.
bool begins_beside_target(Live& live, Time t) {
  const SegmentCopy segment = segment_at(live, t);
  return !segment.has_waypoint &&
         (segment.kind == SegmentKind::entry || segment.kind == SegmentKind::stop);
}

std::size_t count_forms(Live& live, SegmentForm wanted) {
  const Summary& summary = live.solver.summary();
  std::size_t count = 0;
  for (Word n = summary.first; n <= summary.newest; ++n) {
    Time time{};
    SegmentForm form{};
    EXPECT_TRUE(live.board.reader.copy_time(n, summary.revision, time, form));
    count += form == wanted ? 1U : 0U;
  }
  return count;
}

/// Every method that takes waypoints without derivatives.
std::vector<core::WindowOptions> windows_of_all_methods() {
  std::vector<core::WindowOptions> all;
  for (const Method& method : methods()) {
    if (!method.streams() || method.needs_velocity()) continue;
    core::WindowOptions how;
    how.interpolant.method = &method;
    if (method.smooths()) how.interpolant.lambda = 1e-6;
    how.settle = core::default_settle(method);
    how.accepts_short_lag = true;
    all.push_back(how);
  }
  return all;
}

template <typename Test>
void for_each_method(const Test& test) {
  for (const core::WindowOptions& how : windows_of_all_methods()) {
    SCOPED_TRACE(std::string(how.interpolant.method->name));
    Live live(how);
    live.put_all(50, 150);
    test(live);
  }
}

TEST(Cut, InsideASegmentKeepsItsBitsAndBothItsKnots) {
  for_each_method([](Live& live) {
    cut(live, at(105));
    const SegmentCopy segment = segment_at(live, at(104));
    EXPECT_EQ(segment.left, at(100));
    EXPECT_EQ(segment.right, at(105));
    EXPECT_EQ(segment.natural_right, at(110));
    EXPECT_EQ(segment.next, segment.number + 2);
    EXPECT_EQ(count_forms(live, SegmentForm::none), 1U);
    EXPECT_TRUE(begins_beside_target(live, at(105)));
  });
}

TEST(Cut, EarlierInTheSameSegmentKeepsItsBitsToo) {
  for_each_method([](Live& live) {
    const auto before = segment_at(live, at(104)).coefficients;
    cut(live, at(108));
    cut(live, at(103));
    cut(live, at(102));
    const SegmentCopy segment = segment_at(live, at(101));
    EXPECT_EQ(segment.coefficients, before);
    EXPECT_EQ(segment.right, at(102));
    EXPECT_EQ(segment.natural_right, at(110));
    EXPECT_EQ(count_forms(live, SegmentForm::none), 1U);
  });
}

TEST(Cut, InsideTheEntryOfAnotherCutKeepsBoth) {
  for_each_method([](Live& live) {
    cut(live, at(103));
    cut(live, at(107));
    EXPECT_TRUE(begins_beside_target(live, at(104)));
    EXPECT_GE(segment_at(live, at(104)).natural_right, at(113));
    EXPECT_EQ(segment_at(live, at(104)).right, at(107));
    EXPECT_EQ(segment_at(live, at(102)).natural_right, at(110));
    EXPECT_EQ(count_forms(live, SegmentForm::none), 2U);
    cut(live, at(103));  // at the first cut
    EXPECT_EQ(count_forms(live, SegmentForm::none), 1U);
  });
}

TEST(Cut, AtAKnotKeepsTheSegmentThatEndsThere) {
  for_each_method([](Live& live) {
    cut(live, at(110));
    const SegmentCopy segment = segment_at(live, at(109));
    EXPECT_EQ(segment.right, at(110));
    EXPECT_EQ(segment.natural_right, at(110));
    EXPECT_TRUE(begins_beside_target(live, at(110)));
    cut(live, at(110));
    cut(live, at(105));
  });
}

TEST(Cut, InAStopKeepsItsBitsAndItsLength) {
  for_each_method([](Live& live) {
    const Time length = live.window.stop_length;
    const auto before = segment_at(live, at(151));
    ASSERT_EQ(before.kind, SegmentKind::stop);
    cut(live, at(200));
    cut(live, at(180));
    const SegmentCopy stop = segment_at(live, at(160));
    EXPECT_EQ(stop.kind, SegmentKind::stop);
    EXPECT_EQ(stop.coefficients, before.coefficients);
    EXPECT_EQ(stop.right, at(180));
    EXPECT_EQ(stop.natural_right, at(150) + length);
  });
}

TEST(Cut, AtTheEndOfAStopKeepsIt) {
  for_each_method([](Live& live) {
    const Time end = at(150) + live.window.stop_length;
    cut(live, end);
    EXPECT_EQ(segment_at(live, end - Time(1)).kind, SegmentKind::stop);
    EXPECT_TRUE(begins_beside_target(live, end));
    EXPECT_EQ(count_forms(live, SegmentForm::hold), 0U);
  });
}

TEST(Cut, InAHoldKeepsTheStopBeforeIt) {
  for_each_method([](Live& live) {
    const Time end = at(150) + live.window.stop_length;
    cut(live, end + milliseconds(100));
    EXPECT_EQ(segment_at(live, end).kind, SegmentKind::hold);
    EXPECT_EQ(count_forms(live, SegmentForm::hold), 1U);
    cut(live, end + milliseconds(60));
    cut(live, end + milliseconds(30));
    EXPECT_EQ(segment_at(live, end).right, end + milliseconds(30));
    EXPECT_EQ(count_forms(live, SegmentForm::hold), 1U);
    cut(live, end - milliseconds(10));
    EXPECT_EQ(count_forms(live, SegmentForm::hold), 0U);
  });
}

TEST(Cut, ByAStopKeepsTheSegmentBeforeIt) {
  for_each_method([](Live& live) {
    cut(live, at(105), 0);
    EXPECT_EQ(segment_at(live, at(106)).kind, SegmentKind::stop);
    cut(live, at(120), 2);
    cut(live, at(125), 0);
  });
}

TEST(Cut, WorksAfterEachOfManyTakeovers) {
  for_each_method([](Live& live) {
    for (const int ms : {145, 140, 133, 150, 127, 127, 200, 126, 160}) {
      cut(live, at(ms));
      live.replace_solver();
      expect_times_in_order(live);
    }
  });
}

TEST(Cut, ManyTimesKeepsTheBoardInOrderWhileItsSlotsAreReused) {
  core::WindowOptions how;
  how.settle = 2;
  Live live(how, 32, {.history = milliseconds(20)});
  live.put_all(50, 80);
  for (int i = 0; i < 120; ++i) {
    cut(live, at(75 + 10 * i));
    live.clock.time += milliseconds(10);
    live.drain();
    expect_times_in_order(live);
    if (i % 7 == 0) live.replace_solver();
  }
  EXPECT_GT(live.solver.summary().newest, 6 * live.board.layout.capacity);
  EXPECT_GT(live.solver.summary().first, 1U);
}

}  // namespace
}  // namespace splinecast::ipc
