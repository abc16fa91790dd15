#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"
#include "tests/apps/files/ingest.hpp"
#include "tests/fixtures/processes/process.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

/// Rows that the file reader, the append or the solver refuses.
namespace splinecast::apps {
namespace {

using nlohmann::json;
using testing::Ended;
using testing::info;
using testing::own_file;
using testing::Process;
using testing::run;
using testing::shared_file;
using testing::TestFolder;
using Arguments = std::vector<std::string>;

/// A recording and its errors.
struct Case {
  std::string file;
  std::size_t rows;
  std::map<std::string, std::size_t> skipped;  ///< by reason
  std::string first;                           ///< `:line…reason` of the first of them
  Arguments options{};
};

void PrintTo(const Case& played, std::ostream* out) { *out << played.file; }

class IngestOf : public Ingest, public ::testing::WithParamInterface<Case> {};

TEST_P(IngestOf, SkippedRowsAreListedAndCountedAndTheRestIsInterpolated) {
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
  EXPECT_EQ(now["producer"]["appended"], played.rows - skipped + 1);  // plus 1 for the finish
  EXPECT_EQ(now["solver"]["interpolated"], played.rows - skipped);
  EXPECT_EQ(now["solver"]["refused"], 0);
}

TEST_P(IngestOf, TheFirstBadRowIsReportedBeforeAnythingIsSent) {
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
        Case{own_file("gaps.csv"), 150, {}, "", {"--gap", "bridge"}},
        Case{own_file("gaps.csv"),
             150,
             {{"too far apart", 70}},
             ":83: waypoint refused: too far apart",
             {"--max-interval", "3", "--gap", "bridge"}},
        Case{own_file("not_finite.csv"),
             80,
             {{"not finite", 5}, {"unreadable", 4}},
             ":9: waypoint refused: not finite: column 'q3 [rad]': nan"},
        Case{own_file("out_of_order.csv"),
             150,
             {{"out of order", 60}},
             ":7: waypoint refused: out of order"},
        Case{own_file("quaternion_sign_flips.tum"), 150, {}, ""},
        Case{shared_file("data/px4_drone_log/actuator_outputs.csv"),
             130,
             {{"out of order", 56}},
             ":5: waypoint refused: out of order"}));

TEST_F(Ingest, ARowEarlierThanTheFirstIsListed) {
  const TestFolder folder;
  const auto file = folder.write("a.csv", "t,x\n5,0\n4,1\n6,2\n");
  Process solver({"solve", name()});
  const Ended ended = replay(file, {"--on-error", "skip", "--json"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  expect_accounted_for(ended, 3);
  EXPECT_EQ(json::parse(ended.out)["skipped_by_reason"]["out of order"], 1);
}

TEST_F(Ingest, ARowRefusedByAppendIsSkippedOrEndsTheStream) {
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

TEST_F(Ingest, ARowRefusedByTheSolverIsListedWithItsLine) {
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

TEST_F(Ingest, TheSolverReportsTheFirstRefusalOfEachReasonImmediately) {
  const std::string reported =
      "'" + name() +
      "': item 20 refused: lag too short (time 400000000 ns); further ones for this reason";
  for (const std::string& wanted : {name(), name() + "*"}) {
    Process solver(
        {"solve", wanted, "--method", "smoothing", "--lambda", "1e-3", "--settle", "20"});
    EXPECT_EQ(replay(own_file("gaps.csv"), {"--on-error", "skip"}).code, 0);
    solver.await_message("items refused");
    solver.signal(SIGTERM);
    const Ended ended = solver.wait();
    const std::size_t first = ended.err.find(reported);
    EXPECT_NE(first, std::string::npos) << ended.err;
    EXPECT_EQ(ended.err.find("lag too short", first + reported.size()), std::string::npos)
        << ended.err;
    EXPECT_LT(first, ended.err.find("items refused"));
    EXPECT_EQ(run({"rm", name()}).code, 0);
  }
}

TEST_F(Ingest, AProducerThatResumesLateListsItsPastRows) {
  const TestFolder folder;
  std::string rows = "t,x\n";
  for (int i = 0; i < 200; ++i) rows += fmt::format("{},{}\n", 0.01 * i, 0.001 * i);
  const auto file = folder.write("a.csv", rows);
  Process solver({"solve", name()});
  Process replaying(
      {"replay", file, "--stream", name(), "--lead", "100", "--on-error", "skip", "--json"});
  const auto solved = [&](const char* key) {
    const json stream = info(name());  // null before the stream or the solver exists
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

TEST_F(Ingest, EachOfManyRefusalsIsListedAlsoInALoop) {
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
