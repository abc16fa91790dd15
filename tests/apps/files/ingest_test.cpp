#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

/// What becomes of rows that cannot be interpolated: each is named with its line, whoever refused
/// it, and all of them are accounted for.
namespace splinecast::apps {
namespace {

using nlohmann::json;
using testing::Ended;
using testing::info;
using testing::Process;
using testing::run;
using testing::shared_file;
using testing::TestFolder;
using testing::TestStream;
using Arguments = std::vector<std::string>;

std::string own_file(const std::string& name) {
  return std::string(SPLINECAST_SOURCE) + "/tests/data/" + name;
}

/// A recording, and what is wrong with it.
struct Case {
  std::string file;
  std::size_t rows;
  std::map<std::string, std::size_t> skipped;  ///< by reason
  std::string first;                           ///< `:line…reason` of the first of them
  Arguments options{};
};

void PrintTo(const Case& played, std::ostream* out) { *out << played.file; }

class Ingest : public ::testing::Test {
 protected:
  [[nodiscard]] const std::string& name() const { return stream_.name(); }
  [[nodiscard]] Ended replay(const std::string& file, const Arguments& more) const {
    Arguments arguments{"replay", file, "--stream", name(), "--clock", "recorded", "--rate", "max"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  /// Whether a report accounts for `planned` rows, and names each that is not interpolated.
  static void expect_accounted_for(const Ended& ended, std::size_t planned) {
    const auto report = json::parse(ended.out);
    const auto number = [&](const char* key) { return report[key].get<std::size_t>(); };
    EXPECT_EQ(number("sent") + number("skipped") + number("unsent"), planned);
    EXPECT_EQ(number("interpolated") + number("passed_over") + number("refused"), number("sent"));
    EXPECT_EQ(report["rows"].size() + number("rows_not_listed"),
              number("skipped") + number("refused"));
    for (const auto& row : report["rows"]) {
      const std::string line = fmt::format(":{}:", row["line"].get<std::size_t>());
      EXPECT_NE(ended.err.find(line), std::string::npos) << line;
    }
  }
  static std::size_t count(const json& report, const std::string& by) {
    return static_cast<std::size_t>(
        std::ranges::count_if(report["rows"], [&](const json& row) { return row["by"] == by; }));
  }

  TestStream stream_;
};

class IngestOf : public Ingest, public ::testing::WithParamInterface<Case> {};

TEST_P(IngestOf, WhatIsSkippedIsNamedAndCountedAndTheRestIsInterpolated) {
  const Case& played = GetParam();
  REQUIRE_SHARED_FILE(played.file);
  Process solver({"solve", name()});
  Arguments options = played.options;
  options.insert(options.end(), {"--on-error", "skip", "--json"});
  const Ended ended = replay(played.file, options);
  ASSERT_EQ(ended.code, 0) << ended.err;
  expect_accounted_for(ended, played.rows);
  const auto report = json::parse(ended.out);
  std::size_t skipped = 0;
  for (const auto& [reason, count] : report["skipped_by_reason"].items()) {
    const auto wanted = played.skipped.find(reason);
    EXPECT_EQ(count, wanted == played.skipped.end() ? 0 : wanted->second) << reason;
    skipped += count.get<std::size_t>();
  }
  EXPECT_EQ(report["skipped"], skipped);
  EXPECT_EQ(report["refused"], 0);
  const auto now = info(name());
  EXPECT_EQ(now["state"], "finished");
  EXPECT_EQ(now["producer"]["appended"], played.rows - skipped + 1);  // and the finish
  EXPECT_EQ(now["solver"]["interpolated"], played.rows - skipped);
  EXPECT_EQ(now["solver"]["refused"], 0);
}

TEST_P(IngestOf, TheFirstBadRowStopsItByNameBeforeAnythingIsSent) {
  const Case& played = GetParam();
  REQUIRE_SHARED_FILE(played.file);
  Process solver({"solve", name()});
  const Ended ended = replay(played.file, played.options);
  EXPECT_EQ(ended.code, played.skipped.empty() ? 0 : 2) << ended.err;
  if (played.skipped.empty()) return;
  EXPECT_NE(ended.err.find(played.file + played.first), std::string::npos) << ended.err;
  EXPECT_EQ(info(name()), json());
}

INSTANTIATE_TEST_SUITE_P(
    Recordings, IngestOf,
    ::testing::Values(
        Case{own_file("duplicates.csv"), 115, {{"duplicate", 15}}, ":9: waypoint refused: dupl"},
        Case{own_file("duplicates.csv"),
             115,
             {{"duplicate", 8}, {"too close", 57}},
             ":5: waypoint refused: too close",
             {"--min-interval", "0.03"}},
        Case{own_file("gaps.csv"), 150, {}, ""},
        Case{own_file("gaps.csv"),
             150,
             {{"too far apart", 70}},
             ":83: waypoint refused: too far apart",
             {"--max-interval", "3"}},
        Case{own_file("not_finite.csv"),
             80,
             {{"not finite", 5}, {"unreadable", 4}},
             ":34:7: column 'q1 [rad]': '' is not a number"},
        Case{own_file("out_of_order.csv"),
             150,
             {{"out of order", 60}},
             ":7: waypoint refused: out of order"},
        Case{own_file("quaternion_sign_flips.tum"), 150, {}, ""},
        Case{shared_file("data/px4_drone_log/actuator_outputs.csv"),
             130,
             {{"out of order", 56}},
             ":5: waypoint refused: out of order"}));

TEST_F(Ingest, ARowThatIsEarlierThanTheFirstIsNamedAsWell) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n5,0\n4,1\n6,2\n");
  Process solver({"solve", name()});
  const Ended ended = replay(file, {"--on-error", "skip", "--json"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  expect_accounted_for(ended, 3);
  EXPECT_EQ(json::parse(ended.out)["skipped_by_reason"]["out of order"], 1);
}

TEST_F(Ingest, WhatTheAppendRefusesIsNamedAndSkippedOrEndsTheStream) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n5.0000005,0\n6,1\n7,2\n8,1\n");
  const auto leave_unfinished = [&] {
    Producer dies(name(), {.dimensions = 1,
                           .names = {"x"},
                           .clock = StreamClock::recorded,
                           .start = {.kind = ConditionKind::own, .value = {}}});
    const double x = 0;
    ASSERT_EQ(dies.append({.time = Time(5'000'000'000), .position = {&x, 1}}),
              AppendStatus::accepted);
  };
  const std::string message = "a.csv:2: waypoint refused: too close (time 5000000500 ns)";
  Process solver({"solve", name()});

  leave_unfinished();
  const Ended skipped = replay(file, {"--on-error", "skip", "--json"});
  EXPECT_EQ(skipped.code, 0) << skipped.err;
  EXPECT_NE(skipped.err.find(message), std::string::npos) << skipped.err;
  expect_accounted_for(skipped, 4);
  const auto report = json::parse(skipped.out);
  EXPECT_EQ(report["sent"], 3);
  EXPECT_EQ(report["skipped_by_reason"]["too close"], 1);
  EXPECT_EQ(count(report, "producer"), 1U);
  EXPECT_EQ(info(name())["producer"]["refused"]["too close"], 1);
  EXPECT_EQ(info(name())["solver"]["interpolated"], 4);

  leave_unfinished();
  const Ended stopped = replay(file, {"--json"});
  EXPECT_EQ(stopped.code, 2) << stopped.err;
  EXPECT_NE(stopped.err.find(message), std::string::npos) << stopped.err;
  expect_accounted_for(stopped, 4);
  EXPECT_EQ(json::parse(stopped.out)["unsent"], 3);
  EXPECT_EQ(info(name())["state"], "finished");
  EXPECT_EQ(info(name())["solver"]["newest_knot_ns"], 5'000'000'000);
}

TEST_F(Ingest, WhatTheSolverRefusesIsNamedByItsLineThoughTheRingHadTakenIt) {
  Process solver({"solve", name(), "--method", "smoothing", "--lambda", "1e-3", "--settle", "20"});
  const Ended skipped = replay(own_file("gaps.csv"), {"--on-error", "skip", "--json"});
  EXPECT_EQ(skipped.code, 0) << skipped.err;
  expect_accounted_for(skipped, 150);
  const auto report = json::parse(skipped.out);
  EXPECT_EQ(report["refused_by_reason"]["lag too short"], 70);
  EXPECT_EQ(count(report, "solver"), 70U);
  EXPECT_EQ(report["rows"][0]["line"], 23);
  EXPECT_EQ(report["rows"][0]["item"], 20);
  EXPECT_NE(
      skipped.err.find("gaps.csv:23: waypoint refused by the solver: lag too short (item 20)"),
      std::string::npos)
      << skipped.err;
  EXPECT_EQ(info(name())["solver"]["refused_by_reason"]["lag too short"], 70);

  const Ended stopped = replay(own_file("gaps.csv"), {"--json"});
  EXPECT_EQ(stopped.code, 1) << stopped.err;
  EXPECT_NE(stopped.err.find("gaps.csv:23: waypoint refused by the solver"), std::string::npos)
      << stopped.err;
  expect_accounted_for(stopped, 150);
}

TEST_F(Ingest, TheSolverTellsTheFirstRefusalOfEachReasonAtOnce) {
  const std::string told =
      "'" + name() + "': item 20 refused: lag too short (time 400000000 ns); more for this reason";
  for (const std::string& wanted : {name(), name() + "*"}) {
    Process solver(
        {"solve", wanted, "--method", "smoothing", "--lambda", "1e-3", "--settle", "20"});
    EXPECT_EQ(replay(own_file("gaps.csv"), {"--on-error", "skip"}).code, 0);
    solver.await_message("items refused");
    solver.signal(SIGTERM);
    const Ended ended = solver.wait();
    const std::size_t first = ended.err.find(told);
    EXPECT_NE(first, std::string::npos) << ended.err;
    EXPECT_EQ(ended.err.find("lag too short", first + told.size()), std::string::npos) << ended.err;
    EXPECT_LT(first, ended.err.find("items refused"));
    EXPECT_EQ(run({"rm", name()}).code, 0);
  }
}

TEST_F(Ingest, AProducerThatWakesLateIsToldWhatHasGoneBy) {
  const TestFolder folder;
  std::string rows = "t,x\n";
  for (int i = 0; i < 200; ++i) rows += fmt::format("{},{}\n", 0.01 * i, 0.001 * i);
  const auto file = folder.write("a.csv", rows);
  Process solver({"solve", name()});
  Process replaying(
      {"replay", file, "--stream", name(), "--lead", "100", "--on-error", "skip", "--json"});
  const auto solved = [&](const char* key) {
    const json stream = info(name());  // null before there is one, the solver's too
    return stream.is_null() || stream["solver"].is_null()
               ? std::int64_t{0}
               : stream["solver"][key].get<std::int64_t>();
  };
  ASSERT_TRUE(testing::await([&] { return solved("interpolated") > 20; }));
  replaying.signal(SIGSTOP);
  const MonotonicClock clock;
  ASSERT_TRUE(
      testing::await([&] { return clock.now().count() > solved("newest_knot_ns") + 400'000'000; }));
  replaying.signal(SIGCONT);
  const Ended ended = replaying.wait();
  EXPECT_EQ(ended.code, 0) << ended.err;
  expect_accounted_for(ended, 200);
  EXPECT_GT(json::parse(ended.out)["skipped_by_reason"]["past"], 5);
}

/// 200 rows at 100 Hz.
std::string steady_rows() {
  std::string rows = "t,x\n";
  for (int i = 0; i < 200; ++i) rows += fmt::format("{},{}\n", 0.01 * i, 0.001 * i);
  return rows;
}

class LateIngest : public Ingest {
 protected:
  /// Replays a file live, and stops the process until the stream has run dry.
  [[nodiscard]] Ended replay_with_a_pause(const std::string& file, const std::string& policy,
                                          const Arguments& more = {}) const {
    Arguments arguments{"replay", file,   "--stream",   name(), "--lead",   "200",
                        "--late", policy, "--on-error", "skip", "--verify", "--json"};
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

TEST_F(LateIngest, RowsThatNoCurveCanContainAreLeftOutByPass) {
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

TEST_F(LateIngest, ShiftDropsCopiesAndMovesTheRestByAMedianInterval) {
  Process solver({"solve", name()});
  const json report = replay_recorded(own_file("duplicates.csv"), "shift");
  EXPECT_EQ(report["sent"], 104);  // of 15 duplicates 11 are copies
  EXPECT_EQ(report["late"], json::parse(R"({"policy": "shift",
      "by_kind": {"duplicate": 15, "out of order": 0, "past": 0},
      "left_out": 11, "shifts": 4, "shifted_ns": 80000000, "largest_ns": 0})"));
  EXPECT_EQ(info(name())["solver"]["newest_knot_ns"], 1'980'000'000 + 80'000'000);
  const json mixed = replay_recorded(own_file("out_of_order.csv"), "shift");
  EXPECT_GT(mixed["late"]["shifts"], 50);
  EXPECT_EQ(mixed["sent"], 150);
}

TEST_F(LateIngest, ShiftMovesARecordingTheSameWayEachTime) {
  Process solver({"solve", name()});
  const auto last = [&] { return info(name())["solver"]["newest_knot_ns"]; };
  const json first = replay_recorded(own_file("out_of_order.csv"), "shift");
  const json end = last();
  EXPECT_EQ(replay_recorded(own_file("out_of_order.csv"), "shift"), first);
  EXPECT_EQ(last(), end);
}

TEST_F(LateIngest, AClockThatWasSetBackGoesOnAMedianIntervalBehind) {
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

TEST_F(LateIngest, OtherBadRowsStopItWhateverBecomesOfLateOnes) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n0,0\n0,1\n0.1,nan\n0.2,2\n");
  Process solver({"solve", name()});
  const Ended ended = replay(file, {"--late", "pass"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("a.csv:4: waypoint refused: not finite"), std::string::npos);
  EXPECT_EQ(run({"replay", file, "--stream", name(), "--late", "drop"}).code, 2);
}

TEST_F(LateIngest, AProducerThatWakesLateShiftsWhatIsLeft) {
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
  EXPECT_GT(report["late"]["shifted_ns"], 250'000'000);  // the lead, and what it was late
  EXPECT_TRUE(report["verification"]["difference"].is_null());
}

TEST_F(LateIngest, AProducerThatWakesLateWithItsSolverShiftsWhatIsLeftToo) {
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

TEST_F(LateIngest, AProducerThatWakesLateCountsWhatItPassesOn) {
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

TEST_F(Ingest, EachOfManyRefusalsIsNamedAlsoInALoop) {
  const TestFolder folder;
  std::string rows = "t,x\n";
  for (int i = 0; i < 2500; ++i) rows += fmt::format("{},1\n", i);
  const auto file = folder.write("a.csv", rows);
  Process solver({"solve", name(), "--method", "hermite"});
  const Ended ended =
      replay(file, {"--on-error", "skip", "--json", "--loop", "2"});  // with the default ring
  EXPECT_EQ(ended.code, 0);
  const auto report = json::parse(ended.out);
  EXPECT_EQ(report["refused_by_reason"]["lacks derivatives"], 5000);
  EXPECT_EQ(report["rows_not_listed"], 0);
  ASSERT_EQ(report["rows"].size(), 5000U);
  for (std::size_t i = 0; i < 5000; ++i) {
    const json wanted{{"line", i % 2500 + 2},
                      {"by", "solver"},
                      {"reason", "lacks derivatives"},
                      {"item", i},
                      {"loop", i / 2500 + 1}};
    ASSERT_EQ(report["rows"][i], wanted);
  }
}

}  // namespace
}  // namespace splinecast::apps
