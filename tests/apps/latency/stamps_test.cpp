#include "apps/latency/stamps.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "apps/timing/open_loop.hpp"
#include "apps/timing/percentiles.hpp"

namespace splinecast::apps {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// A pipeline in simulated time: every stage takes 1 µs; the producer stalls before one waypoint.
struct SimulatedPipeline {
  Time now = seconds(100);
  std::size_t stall_at = 500;
  Time stall{};
  std::vector<AppendStamp> appends{};
  std::vector<RevisionStamp> revisions{};
  std::vector<SeenStamp> seen{};

  std::vector<Latencies> run_schedule(const Schedule& schedule, const Measured& measured) {
    run(
        schedule,
        [&](Time instant) {
          now = std::max(now, instant);
          return true;
        },
        [&](std::size_t k, Time intended) {
          if (k == stall_at) now += stall;
          AppendStamp append{.item = k, .intended = intended, .begun = now};
          append.appended = now += microseconds(1);
          appends.push_back(append);
          RevisionStamp revision{.revision = k + 1, .consumed = k + 1};
          revision.solved = now += microseconds(1);
          revision.published = now += microseconds(1);
          revisions.push_back(revision);
          seen.push_back({.revision = k + 1, .seen = now += microseconds(1)});
        });
    return latencies_of(appends, revisions, {seen}, {}, measured);
  }
};

Measured all_of(const Schedule& schedule) {
  return {.from = schedule.start,
          .until = schedule.intended(schedule.count),
          .deadline = schedule.period};
}

constexpr Schedule kSchedule{.start = seconds(100), .period = milliseconds(1), .count = 1000};

TEST(OpenLoop, AStallOf50PeriodsShowsAs50LateWaypointsFromTheIntendedInstants) {
  SimulatedPipeline pipeline{.stall = milliseconds(50)};
  const auto stages = pipeline.run_schedule(kSchedule, all_of(kSchedule));
  const Latencies& seen = stages.back();
  ASSERT_EQ(seen.intended.count(), 1000U);
  EXPECT_EQ(seen.missed, 50U);
  EXPECT_EQ(seen.missing, 0U);
  EXPECT_EQ(seen.intended.greatest(), milliseconds(50) + microseconds(4));
  // Late waypoint k waits 50 - k ms plus the work on the ones before it: no late one is omitted.
  const Percentile late = percentile_of(seen.intended, 99'000);
  EXPECT_NEAR(static_cast<double>(late.value.count()), 40e6, 0.1e6);
  // Raw latencies start when the append begins, and do not show the stall.
  EXPECT_EQ(seen.raw.greatest(), microseconds(4));
}

TEST(OpenLoop, WithoutAStallEachLatencyEqualsTheWork) {
  SimulatedPipeline pipeline;
  const auto stages = pipeline.run_schedule(kSchedule, all_of(kSchedule));
  ASSERT_EQ(stages.size(), 4U);
  for (std::size_t i = 0; i < stages.size(); ++i) {
    EXPECT_EQ(stages[i].intended.least(), microseconds(i + 1)) << stages[i].stage;
    EXPECT_EQ(stages[i].intended.greatest(), microseconds(i + 1)) << stages[i].stage;
    EXPECT_EQ(stages[i].missed, 0U);
  }
}

TEST(OpenLoop, EndsEarlyIfTheWaitIsInterrupted) {
  std::size_t sent = 0;
  run(
      kSchedule, [&](Time instant) { return instant < kSchedule.intended(7); },
      [&](std::size_t, Time) { ++sent; });
  EXPECT_EQ(sent, 7U);
}

TEST(Latencies, ExcludeTheWarmUp) {
  SimulatedPipeline pipeline{.stall_at = 10, .stall = milliseconds(50)};
  Measured measured = all_of(kSchedule);
  measured.from += milliseconds(100);
  const auto stages = pipeline.run_schedule(kSchedule, measured);
  EXPECT_EQ(stages.back().intended.count(), 900U);
  EXPECT_EQ(stages.back().missed, 0U);
}

TEST(Latencies, CoverSeveralItemsPerRevisionAndRevisionsThatAReaderSkipped) {
  const std::vector<AppendStamp> appends{
      {.item = 0, .intended = Time(1000), .begun = Time(1010), .appended = Time(1020)},
      {.item = 1, .intended = Time(2000), .begun = Time(2010), .appended = Time(2020)},
      {.item = 2, .intended = Time(3000), .begun = Time(3010), .appended = Time(3020)}};
  const std::vector<RevisionStamp> revisions{
      {.revision = 1, .consumed = 0, .solved = Time(500), .published = Time(510)},
      {.revision = 2, .consumed = 2, .solved = Time(2100), .published = Time(2110)},
      {.revision = 3, .consumed = 2, .solved = Time(2900), .published = Time(2910)},
      {.revision = 4, .consumed = 3, .solved = Time(3100), .published = Time(3110)}};
  const std::vector<SeenStamp> quick{{.revision = 2, .seen = Time(2105)},
                                     {.revision = 4, .seen = Time(3200)}};
  const std::vector<SeenStamp> slow{{.revision = 1, .seen = Time(600)},
                                    {.revision = 3, .seen = Time(2950)}};
  const auto stages =
      latencies_of(appends, revisions, {quick, slow}, {},
                   {.from = Time(0), .until = Time(10'000), .deadline = Time(1000)});
  ASSERT_EQ(stages.size(), 5U);
  EXPECT_EQ(stages[1].stage, "solved");
  EXPECT_EQ(stages[1].intended.least(), Time(100));
  EXPECT_EQ(stages[1].intended.greatest(), Time(1100));
  EXPECT_EQ(stages[1].raw.greatest(), Time(1090));
  EXPECT_EQ(stages[1].missed, 1U);
  EXPECT_EQ(stages[3].intended.greatest(), Time(1105));
  EXPECT_EQ(stages[3].missing, 0U);
  EXPECT_EQ(stages[4].intended.count(), 2U);
  EXPECT_EQ(stages[4].intended.greatest(), Time(1950));
  EXPECT_EQ(stages[4].missing, 1U);
  EXPECT_EQ(stages[4].missed, 2U);
}

TEST(Latencies, CountRefusedItemsAsMissingAndMissed) {
  const std::vector<AppendStamp> appends{
      {.item = 0, .intended = Time(1000), .begun = Time(1010), .appended = Time(1020)},
      {.item = kRefusedItem, .intended = Time(2000), .begun = Time(2010), .appended = Time(2020)},
      {.item = 1, .intended = Time(3000), .begun = Time(3010), .appended = Time(3020)}};
  const std::vector<RevisionStamp> revisions{
      {.revision = 1, .consumed = 2, .solved = Time(3100), .published = Time(3110)}};
  const std::vector<SeenStamp> seen{{.revision = 1, .seen = Time(3200)}};
  const std::vector<ipc::Word> by_solver{0};
  const auto stages =
      latencies_of(appends, revisions, {seen}, by_solver,
                   {.from = Time(0), .until = Time(10'000), .deadline = Time(1000)});
  EXPECT_EQ(stages[0].intended.count(), 2U);
  EXPECT_EQ(stages[0].missing, 1U);
  for (std::size_t i = 1; i < stages.size(); ++i) {
    EXPECT_EQ(stages[i].intended.count(), 1U);
    EXPECT_EQ(stages[i].missing, 2U);
    EXPECT_EQ(stages[i].missed, 2U);
  }
}

TEST(TimeGrid, CountsEachLatencyInItsWindowAndBin) {
  TimeGrid grid(seconds(10), seconds(30));
  grid.record(seconds(10), Time(1024));
  grid.record(seconds(10), Time(1025));
  grid.record(seconds(20), Time(1 << 20));
  grid.record(seconds(99), Time(0));
  const auto found = grid.json();
  const int bins = TimeGrid::kBinsPerOctave;
  EXPECT_EQ(found.at("cells"),
            nlohmann::ordered_json({{0, 10 * bins, 2}, {99, 20 * bins, 1}, {199, 0, 1}}));
  EXPECT_EQ(found.at("greatest_ns")[0], 1025);
  EXPECT_TRUE(found.at("greatest_ns")[1].is_null());
}

}  // namespace
}  // namespace splinecast::apps
