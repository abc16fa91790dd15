#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "splinecast/clock.hpp"
#include "tests/apps/files/ingest.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

/// How `replay` handles late rows.
namespace splinecast::apps {
namespace {

using nlohmann::json;
using testing::Ended;
using testing::info;
using testing::own_file;
using testing::Process;
using testing::run;
using testing::TestFolder;

/// 200 rows at 100 Hz.
std::string steady_rows() {
  std::string rows = "t,x\n";
  for (int i = 0; i < 200; ++i) rows += fmt::format("{},{}\n", 0.01 * i, 0.001 * i);
  return rows;
}

class LateIngest : public Ingest {
 protected:
  /// Replays a file live, and pauses the process until the stream has starved.
  [[nodiscard]] Ended replay_with_a_pause(const std::string& file, const std::string& policy,
                                          const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"replay",     file,   "--stream", name(),
                                       "--lead",     "200",  "--late",   policy,
                                       "--on-error", "skip", "--verify", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Process replaying(arguments);
    const auto solver = [&](const char* key) {
      const json stream = info(name());
      return stream.is_null() || stream["solver"].is_null()
                 ? std::int64_t{0}
                 : stream["solver"][key].get<std::int64_t>();
    };
    EXPECT_TRUE(testing::await([&] { return solver("interpolated") > 40; }));
    replaying.signal(SIGSTOP);
    EXPECT_TRUE(testing::await(
        [&] { return MonotonicClock().now().count() > solver("newest_knot_ns") + 100'000'000; }));
    replaying.signal(SIGCONT);
    return replaying.wait();
  }
  /// Replays onto a recorded stream and verifies it.
  [[nodiscard]] json replay_recorded(const std::string& file, const std::string& policy) const {
    const Ended ended = replay(file, {"--late", policy, "--verify", "--json"});
    EXPECT_EQ(ended.code, 0) << ended.err;
    if (ended.code != 0) return {};
    json report = json::parse(ended.out);
    EXPECT_TRUE(report["verification"]["difference"].is_null()) << report["verification"];
    EXPECT_EQ(report["verification"]["equal"], report["sent"].get<std::size_t>() - 1);
    EXPECT_EQ(report["skipped"], 0);
    EXPECT_EQ(report["refused"], 0);
    return report;
  }
};

TEST_F(LateIngest, PassOmitsDuplicateAndOutOfOrderRows) {
  Process solver({"solve", name()});
  const json report = replay_recorded(own_file("duplicates.csv"), "pass");
  EXPECT_EQ(report["sent"], 100);
  EXPECT_EQ(report["late"], json::parse(R"({"policy": "pass",
      "by_kind": {"duplicate": 15, "out of order": 0, "past": 0},
      "left_out": 15, "shifts": 0, "shifted_ns": 0, "largest_ns": 0})"));
  const json mixed = replay_recorded(own_file("out_of_order.csv"), "pass");
  EXPECT_EQ(mixed["sent"], 90);
  EXPECT_EQ(mixed["late"]["by_kind"]["out of order"], 60);
  EXPECT_EQ(mixed["late"]["left_out"], 60);
  EXPECT_GT(mixed["late"]["largest_ns"], 0);
}

TEST_F(LateIngest, ShiftDropsCopiesAndDelaysTheRestByAMedianInterval) {
  Process solver({"solve", name()});
  const json report = replay_recorded(own_file("duplicates.csv"), "shift");
  EXPECT_EQ(report["sent"], 104);  // 11 of the 15 duplicates are exact copies
  EXPECT_EQ(report["late"], json::parse(R"({"policy": "shift",
      "by_kind": {"duplicate": 15, "out of order": 0, "past": 0},
      "left_out": 11, "shifts": 4, "shifted_ns": 80000000, "largest_ns": 0})"));
  EXPECT_EQ(info(name())["solver"]["newest_knot_ns"], 1'980'000'000 + 80'000'000);
  const json mixed = replay_recorded(own_file("out_of_order.csv"), "shift");
  EXPECT_GT(mixed["late"]["shifts"], 50);
  EXPECT_EQ(mixed["sent"], 150);
}

TEST_F(LateIngest, ShiftGivesTheSameResultEachTime) {
  Process solver({"solve", name()});
  const auto last = [&] { return info(name())["solver"]["newest_knot_ns"]; };
  const json first = replay_recorded(own_file("out_of_order.csv"), "shift");
  const json end = last();
  EXPECT_EQ(replay_recorded(own_file("out_of_order.csv"), "shift"), first);
  EXPECT_EQ(last(), end);
}

TEST_F(LateIngest, AfterABackwardClockStepTimesContinueAMedianIntervalLater) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n5,0\n5.1,1\n5.2,2\n2,3\n2.1,4\n2.1,4\n2.1,5\n");
  Process solver({"solve", name()});
  const json report = replay_recorded(file, "shift");
  EXPECT_EQ(report["sent"], 6);
  EXPECT_EQ(report["late"], json::parse(R"({"policy": "shift",
      "by_kind": {"duplicate": 2, "out of order": 1, "past": 0},
      "left_out": 1, "shifts": 2, "shifted_ns": 3400000000, "largest_ns": 3200000000})"));
  EXPECT_EQ(info(name())["solver"]["newest_knot_ns"], 5'500'000'000);
  EXPECT_EQ(replay_recorded(file, "pass")["sent"], 3);
}

TEST_F(LateIngest, OtherBadRowsStopItUnderAnyLatePolicy) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n0,0\n0,1\n0.1,nan\n0.2,2\n");
  Process solver({"solve", name()});
  const Ended ended = replay(file, {"--late", "pass"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("a.csv:4: waypoint refused: not finite"), std::string::npos);
  EXPECT_EQ(run({"replay", file, "--stream", name(), "--late", "drop"}).code, 2);
}

TEST_F(LateIngest, AProducerThatResumesLateShiftsTheRemainingRows) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", steady_rows());
  Process solver({"solve", name()});
  const Ended ended = replay_with_a_pause(file, "shift");
  EXPECT_EQ(ended.code, 0) << ended.err;
  expect_accounted_for(ended, 200);
  const auto report = json::parse(ended.out);
  EXPECT_EQ(report["skipped"], 0) << ended.err;
  EXPECT_GE(report["late"]["by_kind"]["past"], 1);
  EXPECT_GE(report["late"]["shifts"], 1);
  EXPECT_GT(report["late"]["largest_ns"], 80'000'000);
  EXPECT_GT(report["late"]["shifted_ns"], 250'000'000);  // the lead plus the delay
  EXPECT_TRUE(report["verification"]["difference"].is_null());
}

TEST_F(LateIngest, AProducerThatResumesLateWithItsSolverShiftsTheRemainingRows) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", steady_rows());
  const Ended ended = replay_with_a_pause(file, "shift", {"--embedded"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  expect_accounted_for(ended, 200);
  const auto report = json::parse(ended.out);
  EXPECT_EQ(report["skipped"], 0) << ended.err;
  EXPECT_EQ(report["refused"], 0) << ended.err;
  EXPECT_GE(report["late"]["shifts"], 1);
  EXPECT_TRUE(report["verification"]["difference"].is_null());
}

TEST_F(LateIngest, AProducerThatResumesLateCountsTheLateRowsThatItSends) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", steady_rows());
  Process solver({"solve", name()});
  const Ended ended = replay_with_a_pause(file, "pass");
  EXPECT_EQ(ended.code, 0) << ended.err;
  expect_accounted_for(ended, 200);
  const auto report = json::parse(ended.out);
  EXPECT_GT(report["late"]["by_kind"]["past"], 5);
  EXPECT_EQ(report["late"]["shifts"], 0);
  EXPECT_EQ(report["late"]["left_out"], 0);
  EXPECT_TRUE(report["verification"]["difference"].is_null());
}

}  // namespace
}  // namespace splinecast::apps
