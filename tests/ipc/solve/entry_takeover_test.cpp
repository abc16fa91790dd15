#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "tests/fixtures/streams/watched_stream.hpp"

/// A solver that takes over makes the same entries as its predecessor would have made.
namespace splinecast::ipc::entries {
namespace {

/// The actions of a scenario on a stream.
using Script = std::function<void(Watched&)>;

struct Scenario {
  const char* name;
  double limit;
  Script play;
  bool appends_only = true;
};

void starve_and_wait(Watched& live) {
  live.send_all(50, 300, 60);
  live.run_to(700);
  live.send_all(800, 1600, 20);
}

void enter(Watched& live) {
  live.send_all(50, 300, 60);
  live.run_to(600);
  for (int ms = 700; ms <= 1200; ms += 10) live.send(ms);
  live.run_to(1000);
  live.send_all(1210, 1800, 100);
}

void end_ahead(Watched& live) {
  live.send_all(50, 300, 60);
  live.run_to(800);
  live.send_all(860, 3000, 60);
}

void starve_twice(Watched& live) {
  live.send_all(50, 500, 60);
  live.run_to(900);
  live.send_all(950, 2000, 50);
  live.run_to(2300);
  live.send_all(2310, 3000, 30);
}

void start_from_rest(Watched& live) {
  for (int ms = 100; ms <= 1500; ms += 10) {
    live.run_to(std::max(ms - 400, 0));
    live.send(ms, 1e-3 * ms);
  }
}

void replace_five_times(Watched& live) {
  live.send_all(50, 500, 100);
  for (int i = 0; i < 5; ++i) {
    const int from = 500 + 200 * i;
    live.run_to(from - 50);
    std::vector<Time> times;
    for (int ms = from + 30; ms <= from + 300; ms += 10) times.push_back(at(ms));
    EXPECT_EQ(live.replace(at(from), times), AppendStatus::accepted);
  }
  live.run_to(1550);
}

void finish_late(Watched& live) {
  live.send_all(50, 800, 60);
  live.run_to(1000);
}

std::vector<Scenario> scenarios() {
  return {{"waiting", 3, starve_and_wait},   {"entering", 8, enter},
          {"beyond", 2, end_ahead},          {"without limits", 0, starve_twice},
          {"from rest", 4, start_from_rest}, {"replacements", 6, replace_five_times, false},
          {"late finish", 2, finish_late}};
}

TEST(Entry, IsBitIdenticalIfANewSolverTakesOverBeforeEachSearch) {
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
    // Without limits the entry depends on the past motion, which a new solver does not fully know.
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
    EXPECT_EQ(one.solver.summary().passed_over, many.solver.summary().passed_over);
    EXPECT_EQ(one.solver.summary().knots, many.solver.summary().knots);
  }
}

TEST(Entry, IsVerifiedIfASolverDiesAtAnyTime) {
  for (const Scenario& scenario : scenarios()) {
    for (int dies_at = 105; dies_at <= 1500; dies_at += 97) {
      SCOPED_TRACE(::testing::Message() << scenario.name << ", dies at " << dies_at);
      Watched live(limited(scenario.limit));
      live.takes_over_at = at(dies_at);
      scenario.play(live);
      live.end();
      ASSERT_EQ(live.verified(), "");
      if (scenario.appends_only) {
        ASSERT_EQ(live.met(), live.solver.summary().interpolated());
      }
    }
  }
}

}  // namespace
}  // namespace splinecast::ipc::entries
