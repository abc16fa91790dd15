#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "core/forms/stop.hpp"
#include "core/online/extrapolation.hpp"
#include "ipc/verification/settled_segments.hpp"
#include "ipc/verification/verify.hpp"
#include "tests/fixtures/streams/item_record.hpp"
#include "tests/fixtures/streams/live_stream.hpp"

/// How a curve comes back to its waypoints, which of them it passes over, and that this is counted,
/// recorded and survives the solver.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::LiveStream;

constexpr Condition kHalt{.kind = ConditionKind::halt, .value = {}};

/// A motion that begins at rest 50 ms after the start: up to 1 /s and 1 /s².
double motion(Time t) {
  const double s = to_seconds(t - LiveStream::kNow) - 0.05;
  return 0.5 * s - 0.25 * std::sin(2 * s);
}

Time at(int ms) { return LiveStream::kNow + milliseconds(ms); }

core::WindowOptions limited(double acceleration) {
  core::WindowOptions how;
  how.limits.acceleration = {acceleration};
  return how;
}

/// A live stream whose curve, items and refusals are all kept.
struct Watched : LiveStream {
  struct Sent {
    Time time{};
    double position = 0;
  };

  explicit Watched(core::WindowOptions how = {}, bool takes_over = false)
      : LiveStream(std::move(how), 1024, {.history = seconds(2)}),
        items(1),
        collected(board.reader, true),
        takes_over_each_step(takes_over) {}

  void step() {
    note();
    if ((takes_over_each_step && !is_searching) || clock.time >= takes_over_at) {
      replace_solver();
      takes_over_at = Time::max();
    }
    solver.step(clock);
    is_searching = solver.due() <= clock.time;
    note();
    const Head& head = solver.head();
    EXPECT_EQ(head.consumed, head.knots + head.refused + head.withdrawn + head.controls);
    EXPECT_LE(head.passed_over, head.knots);
  }
  void note() {
    items.note_items(ring.reader);
    items.note_refusals(board.reader, solver.head().refused);
    collected.look();
  }
  void run_to(int ms) {
    for (; clock.time < at(ms); clock.time += milliseconds(1)) step();
  }
  /// Sends a waypoint whatever the producer knows.
  void send(int ms, double position) {
    ASSERT_EQ(
        ring.writer.append({.time = at(ms), .position = {&position, 1}}, {board.reader.tail()}),
        AppendStatus::accepted)
        << ms;
    sent.push_back({at(ms), position});
  }
  void send(int ms) { send(ms, motion(at(ms))); }
  /// One every 10 ms, each `lead` before its time, while the clock goes on.
  void send_all(int from_ms, int to_ms, int lead) {
    for (int ms = from_ms; ms <= to_ms; ms += 10) {
      run_to(ms - lead);
      send(ms);
    }
    step();
  }
  void end() {
    while (ring.writer.finish(kHalt, {board.reader.tail()}) == AppendStatus::full) step();
    for (int i = 0; i < 5000 && !solver.head().finished; ++i) {
      step();
      clock.time += milliseconds(1);
    }
    ASSERT_TRUE(solver.head().finished);
    note();
  }
  [[nodiscard]] std::string verified() {
    const Verification found = verify({.window = window,
                                       .kinds = kinds,
                                       .items = items.items(),
                                       .segments = collected.segments(),
                                       .head = collected.head(),
                                       .end = kHalt});
    if (!found.first) return found.equal > 0 ? "" : "nothing was compared";
    return std::to_string(found.first->segment) + ": " + found.first->what + ", " +
           found.first->published + " published, " + found.first->solved + " solved";
  }
  /// Sent waypoints that the curve passes at their time, or ends at.
  [[nodiscard]] Word met() const {
    Word count = 0;
    for (const Sent& waypoint : sent) count += is_met(waypoint) || ends_at(waypoint) ? 1U : 0U;
    return count;
  }
  [[nodiscard]] bool is_met(const Sent& waypoint) const {
    return std::ranges::any_of(collected.segments(), [&](const SegmentCopy& s) {
      const double begin = s.has_waypoint ? s.waypoint[0] : s.coefficients[0];
      return s.left == waypoint.time && begin == waypoint.position;
    });
  }
  /// Where the curve ends no segment begins.
  [[nodiscard]] bool ends_at(const Sent& waypoint) const {
    const SegmentCopy& last = collected.segments().back();
    State end(1);
    core::evaluate(last.order, last.coefficients, to_seconds(last.right - last.left), end.ref());
    return waypoint.time == sent.back().time &&
           std::abs(end.position()[0] - waypoint.position) < 1e-9;
  }
  /// The largest derivative of what the solver has chosen itself: entries, stops and the like.
  [[nodiscard]] double peak(int derivative) const {
    State at(1);
    double most = 0;
    for (const SegmentCopy& s : collected.segments()) {
      if (s.kind == SegmentKind::spline && s.has_waypoint) continue;
      const double h = to_seconds(s.right - s.left);
      for (int i = 0; i <= 50; ++i) {
        core::evaluate(s.order, s.coefficients, h * i / 50, at.ref());
        const auto values = derivative == 1 ? at.velocity() : at.acceleration();
        most = std::max(most, std::abs(values[0]));
      }
    }
    return most;
  }
  [[nodiscard]] std::size_t entries() const {
    return static_cast<std::size_t>(
        std::ranges::count(collected.segments(), SegmentKind::splice, &SegmentCopy::kind));
  }
  [[nodiscard]] Course course() const { return static_cast<Course>(solver.head().course); }

  std::vector<Sent> sent;
  testing::ItemRecord items;
  SettledSegments collected;
  bool takes_over_each_step;  ///< but not within a search, which the next solver begins again
  bool is_searching = false;
  Time takes_over_at = Time::max();  ///< once
};

void expect_continuous(const Watched& live) {
  const auto segments = live.collected.segments();
  State left(1);
  State right(1);
  for (std::size_t i = 1; i < segments.size(); ++i) {
    const SegmentCopy& before = segments[i - 1];
    ASSERT_EQ(before.right, segments[i].left);
    ASSERT_EQ(before.next, segments[i].number);
    core::evaluate(before.order, before.coefficients, to_seconds(before.right - before.left),
                   left.ref());
    core::evaluate(segments[i].order, segments[i].coefficients, 0, right.ref());
    EXPECT_NEAR(left.position()[0], right.position()[0], 1e-11);
    EXPECT_NEAR(left.velocity()[0], right.velocity()[0], 1e-9);
  }
}

TEST(Entry, LeadsBackToTheWaypointsAfterAStarvationAndPassesOverThoseBeforeItsEnd) {
  for (const double limit : {0.0, 3.0, 10.0}) {
    SCOPED_TRACE(limit);
    Watched live(limited(limit));
    live.send_all(50, 500, 60);
    live.run_to(700);
    EXPECT_TRUE(live.solver.head().starved);
    EXPECT_EQ(live.course(), Course::waiting);
    EXPECT_EQ(live.solver.head().underruns, 1U);
    live.send_all(800, 2500, 300);
    EXPECT_FALSE(live.solver.head().starved);
    EXPECT_EQ(live.course(), Course::on_target);
    for (int ms = 2300; ms <= 2500; ms += 10) {
      EXPECT_NEAR(live.position_at(at(ms)), motion(at(ms)), 1e-12) << ms;
    }
    const Head& head = live.solver.head();
    EXPECT_EQ(head.refused, 0U);
    EXPECT_EQ(head.knots, live.sent.size());
    EXPECT_GT(head.passed_over, 0U);
    EXPECT_GE(live.entries(), 1U);
    live.end();
    EXPECT_EQ(live.met(), live.solver.head().interpolated());
    expect_continuous(live);
    EXPECT_EQ(live.verified(), "");
    if (limit > 0) {
      EXPECT_LE(live.peak(2), limit * (1 + 1e-6));
    }
  }
}

TEST(Entry, CountsNothingAsPassedOverWhereTheCurveMeetsAllItsWaypoints) {
  Watched live;
  live.send_all(50, 1000, 150);
  live.end();
  EXPECT_EQ(live.solver.head().passed_over, 0U);
  EXPECT_EQ(live.solver.head().interpolated(), live.sent.size());
  EXPECT_EQ(live.met(), live.sent.size());
  EXPECT_EQ(live.verified(), "");
}

TEST(Entry, MeetsTheFirstWaypointThatItsLimitsAllowAndNotTheOnesBefore) {
  Watched live(limited(8));
  live.send_all(50, 300, 60);
  live.run_to(600);  // at rest behind x(0.3)
  const double rest = live.position_at(at(600));
  // All at once, ahead and near by: the curve has to cover the way from its rest.
  for (int ms = 650; ms <= 1500; ms += 10) live.send(ms, rest + 0.05);
  live.drain();
  live.note();
  ASSERT_EQ(live.course(), Course::entering);
  const Head& head = live.solver.head();
  EXPECT_GT(head.passed_over, 0U);
  live.run_to(1510);
  // Rest to rest over 0.05 within 8: at least 0.19 s from 605 ms on.
  const double least = std::sqrt(10 / std::sqrt(3.0) * 0.05 / 8);
  const auto entry =
      std::ranges::find(live.collected.segments(), SegmentKind::splice, &SegmentCopy::kind);
  ASSERT_NE(entry, live.collected.segments().end());
  const double took = to_seconds(entry->right - entry->left);
  EXPECT_GE(took, least - 1e-6);
  EXPECT_LE(took, least + 0.02 + 1e-6);  // two knots' distance at most
  EXPECT_LE(live.peak(2), 8 * (1 + 1e-6));
}

TEST(Entry, OfAStreamThatIsLateLeavesTheCountsThatItsSegmentsShow) {
  for (const double limit : {0.0, 5.0}) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      SCOPED_TRACE(::testing::Message() << "limit " << limit << ", seed " << seed);
      std::mt19937_64 random(seed);
      Watched live(limited(limit));
      int ms = 100;
      while (ms < 4000) {
        // Each up to 40 ms too late, or with lead.
        live.run_to(ms - 60 + static_cast<int>(random() % 100));
        live.send(ms);
        ms += 20 + static_cast<int>(random() % 20) + (random() % 20 == 0 ? 300 : 0);
      }
      live.end();
      const Head& head = live.solver.head();
      EXPECT_EQ(head.knots + head.refused, live.sent.size());
      EXPECT_EQ(live.met(), head.interpolated());
      expect_continuous(live);
      EXPECT_EQ(live.verified(), "");
      if (limit > 0) {
        EXPECT_LE(live.peak(2), limit * (1 + 1e-6));
      }
    }
  }
}

TEST(Entry, IsShapedByAWaypointThatComesAQuarterSecondLateAndByNoneThatIsOlder) {
  for (const int late : {1, 100, 250, 251, 400}) {
    Watched live;
    live.send_all(50, 300, 60);
    live.run_to(1000);
    live.send(1005 - late);  // settled is 1005
    live.step();
    const Head& head = live.solver.head();
    const bool is_taken = late <= 250;
    EXPECT_EQ(live.reason(Refusal::past), is_taken ? 0U : 1U) << late;
    EXPECT_EQ(head.refused, is_taken ? 0U : 1U) << late;
    EXPECT_EQ(head.passed_over, is_taken ? 1U : 0U) << late;
    EXPECT_EQ(head.knots, is_taken ? 27U : 26U) << late;
  }
}

TEST(Entry, IsNotLedToAWaypointThatWasLate) {
  Watched live;
  live.send_all(50, 300, 60);
  live.run_to(1000);
  const double before = live.position_at(at(1005));
  live.send(900);
  live.step();
  EXPECT_EQ(live.position_at(at(1005)), before);  // nothing of what has settled
  live.send_all(1100, 2000, 60);
  live.end();
  EXPECT_EQ(live.met(), live.solver.head().interpolated());
  EXPECT_EQ(live.verified(), "");
}

TEST(Entry, WithoutAWaypointInReachGoesBeyondTheNewestOneAlongALineToAStop) {
  Watched live(limited(2));
  live.send_all(50, 300, 60);
  live.run_to(800);
  live.send(900);
  live.send(910);
  live.send(920);
  live.drain();
  live.note();
  ASSERT_EQ(live.course(), Course::beyond);
  EXPECT_EQ(live.solver.head().passed_over, 3U);
  // The line, where there still is one, goes on from the newest waypoint at its velocity.
  const Time line_end = at(920) + core::Extrapolation::kLine;
  State end(1);
  EXPECT_TRUE(has_values(live.sampler.preview(line_end, end.ref())));
  live.run_to(3000);
  EXPECT_EQ(live.sampler.sample(at(2900), live.state.ref()), SampleStatus::holding);
  EXPECT_LE(live.peak(2), 2 * (1 + 1e-6));
  expect_continuous(live);
  EXPECT_EQ(live.verified(), "");
}

TEST(Entry, BeyondTheNewestWaypointIsMadeAgainForANewerOneUntilItMeetsOne) {
  Watched live(limited(2));
  live.send_all(50, 300, 60);
  live.run_to(800);
  live.send_all(860, 3500, 60);
  EXPECT_TRUE(live.course() == Course::on_target);
  live.end();
  EXPECT_EQ(live.met(), live.solver.head().interpolated());
  EXPECT_GT(live.solver.head().interpolated(), 40U);
  EXPECT_LE(live.peak(2), 2 * (1 + 1e-6));
  EXPECT_EQ(live.verified(), "");
}

/// More candidates than one step may try: those that only the jerk forbids.
TEST(Entry, IsFoundHoweverManyStepsItsSearchTakes) {
  core::WindowOptions how;
  how.limits = {.acceleration = {10}, .jerk = {15}};
  Watched live(how);
  for (int ms = 100; ms <= 300; ms += 10) {
    live.run_to(ms - 60);
    live.send(ms, 0);
  }
  live.run_to(800);
  ASSERT_EQ(live.course(), Course::waiting);
  for (int ms = 900; ms <= 4000; ms += 10) {
    live.run_to(ms - 100);
    live.send(ms, 0.1);
  }
  EXPECT_EQ(live.course(), Course::on_target);
  EXPECT_NEAR(live.position_at(at(4000)), 0.1, 1e-12);
}

/// Not made again and again: a plan whose end recedes with every waypoint never comes to it.
TEST(Entry, IsOverInASecondAlsoWhereANewWaypointComesEveryTenMilliseconds) {
  for (const double limit : {3.0, 10.0}) {
    SCOPED_TRACE(limit);
    Watched live(limited(limit));
    live.send_all(50, 500, 60);
    live.run_to(700);
    live.send_all(800, 2200, 80);
    EXPECT_EQ(live.course(), Course::on_target);
    EXPECT_NEAR(live.position_at(at(2200)), motion(at(2200)), 1e-12);
  }
}

TEST(Entry, ThatEndsAtAWaypointStandsWhateverComesBehindIt) {
  Watched live(limited(8));
  live.send_all(50, 300, 60);
  live.run_to(600);
  for (int ms = 650; ms <= 1200; ms += 10) live.send(ms, 0.1);
  live.step();
  live.drain();
  ASSERT_EQ(live.course(), Course::entering);
  live.run_to(610);  // the entry has begun
  const double on_the_way = live.position_at(at(660));
  const Word passed = live.solver.head().passed_over;
  for (int ms = 1210; ms <= 1250; ms += 10) live.send(ms, 0.1 + 0.01 * (ms - 1200));
  live.drain();
  EXPECT_EQ(live.position_at(at(660)), on_the_way);
  EXPECT_EQ(live.solver.head().passed_over, passed);
}

TEST(Entry, IgnoresWaypointsThatAreRefusedWhileItIsBeingLookedFor) {
  Watched live(limited(1));
  live.send_all(50, 300, 60);
  live.run_to(800);
  live.send(900);
  live.step();
  // What the producer did not know to be one.
  live.replace_producer();
  const double x = 0.3;
  const auto send_blindly = [&](int ms) {
    WaypointRingWriter blind(live.ring.bytes.span(), live.ring.layout,
                             {.min_interval = Time::min()});
    return blind.append({.time = at(ms), .position = {&x, 1}}, {});
  };
  for (const int ms : {900, 890}) {
    const Word before = live.solver.head().refused;
    const Word passed = live.solver.head().passed_over;
    if (send_blindly(ms) != AppendStatus::accepted) continue;
    live.step();
    EXPECT_EQ(live.solver.head().refused, before + 1) << ms;
    EXPECT_EQ(live.solver.head().passed_over, passed) << ms;
  }
}

/// A start from rest whose first interval asks for more than the limit, however many waypoints the
/// first step finds.
TEST(Entry, BeginsAStreamWhoseFirstIntervalAsksForMoreThanItsLimit) {
  for (const double limit : {5.0, 0.0}) {
    for (const int at_once : {2, 8, 31}) {
      SCOPED_TRACE(::testing::Message() << "limit " << limit << ", " << at_once << " at once");
      Watched live(limited(limit));
      const auto send = [&](int ms) { live.send(ms, 1e-3 * ms); };  // at once at 1 /s
      for (int i = 0; i < at_once; ++i) send(300 + 10 * i);
      live.drain();
      for (int ms = 300 + 10 * at_once; ms <= 2000; ms += 10) {
        live.run_to(ms - 300);
        send(ms);
      }
      live.end();
      const Head& head = live.solver.head();
      EXPECT_GE(head.passed_over, 1U);
      EXPECT_EQ(live.met(), head.interpolated());
      ASSERT_FALSE(live.collected.segments().empty());
      EXPECT_NE(live.collected.segments()[0].kind, SegmentKind::spline);
      EXPECT_EQ(live.collected.segments()[0].left, at(300));
      if (limit > 0) {
        EXPECT_LE(live.peak(2), limit * (1 + 1e-6));
      }
      EXPECT_EQ(live.verified(), "");
    }
  }
}

TEST(Entry, IsNotNeededByAStartThatKeepsItsLimit) {
  Watched live(limited(5));
  for (int ms = 100; ms <= 1500; ms += 10) {
    live.run_to(ms - 100);
    live.send(ms, 1 - std::cos(1e-3 * (ms - 100)));
  }
  live.end();
  EXPECT_EQ(live.solver.head().passed_over, 0U);
  EXPECT_EQ(live.entries(), 0U);
  EXPECT_EQ(live.verified(), "");
}

TEST(Entry, ToTheLastWaypointEndsAStreamThatFinishesBehindIt) {
  for (const int late : {0, 100, 500}) {  // frozen, in the stop, and at rest
    for (const double limit : {0.0, 5.0}) {
      SCOPED_TRACE(::testing::Message() << late << " ms late, limit " << limit);
      Watched live(limited(limit));
      live.send_all(50, 800, 60);
      live.run_to(796 + late);
      live.end();
      const Time end = live.solver.head().settled_until;
      EXPECT_GT(end, at(800));  // later than its own time
      EXPECT_LT(end, at(800 + late) + seconds(3));
      EXPECT_NEAR(live.position_at(end), motion(at(800)), 1e-12);
      EXPECT_NEAR(live.position_at(end + seconds(5)), motion(at(800)), 1e-12);
      EXPECT_EQ(live.sampler.preview(end + seconds(5), live.state.ref()), SampleStatus::holding);
      if (limit > 0) {
        EXPECT_LE(live.peak(2), limit * (1 + 1e-6));
      }
      expect_continuous(live);
      EXPECT_EQ(live.verified(), "");
    }
  }
}

TEST(Entry, ToTheLastWaypointEndsAsLateAsTheLimitAsksFor) {
  Watched live(limited(1));
  live.send_all(50, 300, 60);
  live.run_to(1500);
  live.send(1600, 30.0);  // far away
  live.send(1610, 30.0);
  live.end();
  const Time end = live.solver.head().settled_until;
  const double least = std::sqrt(10 / std::sqrt(3.0) * 29.5);
  EXPECT_GT(to_seconds(end - at(1500)), 0.9 * least);
  EXPECT_LT(to_seconds(end - at(1500)), 1.3 * least);
  EXPECT_NEAR(live.position_at(end), 30, 1e-9);
  EXPECT_LE(live.peak(2), 1 + 1e-6);
  EXPECT_EQ(live.verified(), "");
}

/// What happens to a stream, step by step.
using Script = std::function<void(Watched&)>;

struct Scenario {
  const char* name;
  double limit;
  Script play;
  bool appends_only = true;
};

std::vector<Scenario> scenarios() {
  return {{"waiting", 3,
           [](Watched& live) {
             live.send_all(50, 300, 60);
             live.run_to(700);
             live.send_all(800, 1600, 20);
           }},
          {"entering", 8,
           [](Watched& live) {
             live.send_all(50, 300, 60);
             live.run_to(600);
             for (int ms = 700; ms <= 1200; ms += 10) live.send(ms);
             live.run_to(1000);
             live.send_all(1210, 1800, 100);
           }},
          {"beyond", 2,
           [](Watched& live) {
             live.send_all(50, 300, 60);
             live.run_to(800);
             live.send_all(860, 3000, 60);
           }},
          {"without limits", 0,
           [](Watched& live) {
             live.send_all(50, 500, 60);
             live.run_to(900);
             live.send_all(950, 2000, 50);
             live.run_to(2300);
             live.send_all(2310, 3000, 30);
           }},
          {"from rest", 4,
           [](Watched& live) {
             for (int ms = 100; ms <= 1500; ms += 10) {
               live.run_to(std::max(ms - 400, 0));
               live.send(ms, 1e-3 * ms);
             }
           }},
          {"replacements", 6,
           [](Watched& live) {
             live.send_all(50, 500, 100);
             for (int i = 0; i < 5; ++i) {
               const int from = 500 + 200 * i;
               live.run_to(from - 50);
               std::vector<Time> times;
               for (int ms = from + 30; ms <= from + 300; ms += 10) times.push_back(at(ms));
               EXPECT_EQ(live.replace(at(from), times), AppendStatus::accepted);
             }
             live.run_to(1550);
           },
           false},
          {"late finish", 2, [](Watched& live) {
             live.send_all(50, 800, 60);
             live.run_to(1000);
           }}};
}

TEST(Entry, IsTheSameToItsBitsWhereAnotherSolverTakesOverBeforeEveryStepThatEndsItsSearch) {
  for (const Scenario& scenario : scenarios()) {
    SCOPED_TRACE(scenario.name);
    Watched one(limited(scenario.limit));
    Watched many(limited(scenario.limit), true);
    for (Watched* live : {&one, &many}) {
      scenario.play(*live);
      live->end();
      EXPECT_EQ(live->verified(), "") << (live == &many ? "taken over" : "undisturbed");
      expect_continuous(*live);
    }
    // Without limits what the motion has shown decides, of which a solver that takes over knows
    // less.
    if (scenario.limit == 0) continue;
    const auto a = one.collected.segments();
    const auto b = many.collected.segments();
    EXPECT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      ASSERT_EQ(a[i].left, b[i].left) << i;
      ASSERT_EQ(a[i].right, b[i].right) << i;
      ASSERT_EQ(a[i].kind, b[i].kind) << i;
      ASSERT_EQ(a[i].coefficients, b[i].coefficients) << i;
    }
    EXPECT_EQ(one.solver.head().passed_over, many.solver.head().passed_over);
    EXPECT_EQ(one.solver.head().knots, many.solver.head().knots);
  }
}

TEST(Entry, IsVerifiedWhereOneSolverDiesAtAnyTime) {
  for (const Scenario& scenario : scenarios()) {
    for (int dies_at = 105; dies_at <= 1500; dies_at += 97) {
      SCOPED_TRACE(::testing::Message() << scenario.name << ", dies at " << dies_at);
      Watched live(limited(scenario.limit));
      live.takes_over_at = at(dies_at);
      scenario.play(live);
      live.end();
      ASSERT_EQ(live.verified(), "");
      if (scenario.appends_only) {
        ASSERT_EQ(live.met(), live.solver.head().interpolated());
      }
    }
  }
}

}  // namespace
}  // namespace splinecast::ipc
