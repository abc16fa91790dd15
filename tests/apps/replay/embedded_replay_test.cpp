#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "apps/replay/player.hpp"
#include "apps/tables/table_rows.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/reader.hpp"
#include "tests/fixtures/processes/process.hpp"

/// `replay --embedded` on a live stream; a thread of this process plays it.
namespace splinecast::apps {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Three waypoints, 1 s apart.
WaypointTable sparse_table() {
  WaypointTable table;
  table.file = "sparse";
  table.names = {"x"};
  table.times = {Time(0), seconds(1), seconds(2)};
  table.kinds = {Dimension{}};
  table.lines = {2, 3, 4};
  table.positions = {0, 1, 3};
  return table;
}

/// Plays a table.
ReplayReport play(const WaypointTable& table, const ReplayOptions& options) {
  RefusedRows refused;
  Recording recording(std::make_unique<TableRows>(table), table.kinds, preparation_of(options),
                      nullptr);
  return replay_recording(recording, options, refused);
}

TEST(EmbeddedReplay, SettlesTheCurveBetweenWaypointsThatAreFarApart) {
  const testing::TestStream stream;
  // Wide margins for a busy machine: freeze-ahead is 400 ms, and the solver is due every 200 ms.
  const ReplayOptions options{
      .stream = stream.name(),
      .lead = milliseconds(1500),
      .embedded = true,
      .quiet = true,
      .solver = {.freeze_ahead = milliseconds(400), .min_entry = milliseconds(5)}};
  const WaypointTable table = sparse_table();
  ReplayReport report;
  std::thread replaying([&] { report = play(table, options); });
  Reader reader(stream.name(), testing::kPatience);
  State state(reader.dimensions());
  const MonotonicClock clock;
  ipc::Summary summary;
  std::array<std::size_t, kSampleStatuses> count{};
  const Time patience = clock.now() + testing::kPatience;
  for (Time now = clock.now(); now < patience; now = clock.now()) {
    const SampleStatus status = reader.sample(now, state);
    ++count[static_cast<std::size_t>(status)];
    if (ipc::Internals::summary(reader, summary) && summary.finished && now > summary.newest_time)
      break;
    (void)reader.wait(milliseconds(1));
  }
  replaying.join();
  EXPECT_EQ(report.interpolated, 3U);
  EXPECT_GT(count[static_cast<std::size_t>(SampleStatus::settled)], 0U);
  EXPECT_EQ(count[static_cast<std::size_t>(SampleStatus::provisional)], 0U);
}

/// Positions of a motion at 100 Hz for 0.5 s; `motion` takes seconds.
std::string recording(double (*motion)(double)) {
  std::string text = "t,x\n";
  for (int i = 0; i <= 50; ++i) {
    const double s = 0.01 * i;
    text += fmt::format("{},{}\n", s, motion(s));
  }
  return text;
}

class PassedOver : public ::testing::Test {
 protected:
  [[nodiscard]] testing::Ended replay(double (*motion)(double),
                                      const std::vector<std::string>& more = {}) const {
    const testing::TestFolder folder;
    // The long lead prevents late waypoints also on a busy machine.
    std::vector<std::string> arguments{"replay",     folder.write("a.csv", recording(motion)),
                                       "--stream",   stream_.name(),
                                       "--embedded", "--lead",
                                       "1500"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return testing::run(arguments);
  }
  testing::TestStream stream_;
};

TEST_F(PassedOver, AreWaypointsBeforeTheEndOfTheEntryIfTheRecordingStartsInMotion) {
  const testing::Ended ended = replay([](double s) { return s; }, {"--json"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto report = nlohmann::json::parse(ended.out);
  const auto count = [&](const char* key) { return report[key].get<int>(); };
  EXPECT_EQ(count("sent"), 51);
  EXPECT_EQ(count("refused"), 0);
  EXPECT_GT(count("passed_over"), 0);
  EXPECT_GT(count("interpolated"), 0);
  EXPECT_EQ(count("interpolated") + count("passed_over"), 51);
  const auto solver = testing::info(stream_.name())["solver"];
  EXPECT_EQ(solver["passed_over"], report["passed_over"]);
  EXPECT_EQ(solver["interpolated"], report["interpolated"]);
}

TEST_F(PassedOver, AreCountedInTheFinalMessage) {
  const testing::Ended ended = replay([](double s) { return s; });
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto solver = testing::info(stream_.name())["solver"];
  EXPECT_NE(ended.err.find(
                fmt::format("51 waypoints sent, {} interpolated, {} passed over, 0 refused",
                            solver["interpolated"].get<int>(), solver["passed_over"].get<int>())),
            std::string::npos)
      << ended.err;
}

TEST_F(PassedOver, IsZeroForARecordingThatStartsAtRestAndIsNeverLate) {
  const testing::Ended ended = replay([](double s) { return 1 - std::cos(3 * s); }, {"--json"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto report = nlohmann::json::parse(ended.out);
  EXPECT_EQ(report["interpolated"], 51);
  EXPECT_EQ(report["passed_over"], 0);
}

TEST(EmbeddedReplay, OntoAMovingStreamWaitsForTheEndOfItsMotion) {
  const testing::TestStream stream;
  const ReplayOptions options{.stream = stream.name(),
                              .lead = milliseconds(700),
                              .start_from = FromFirst{},
                              .embedded = true,
                              .quiet = true};
  WaypointTable table = sparse_table();
  table.times = {Time(0), milliseconds(300), milliseconds(600)};
  std::thread replaying([&] {
    (void)play(table, options);
    (void)play(table, options);
  });
  Reader reader(stream.name(), testing::kPatience);
  State state(reader.dimensions());
  const MonotonicClock clock;
  const Time patience = clock.now() + testing::kPatience;
  Time now = clock.now();
  while (now < patience && reader.sample(now, state) != SampleStatus::retired) {
    (void)reader.wait(milliseconds(1));
    now = clock.now();
  }
  ipc::Summary old;  // the reader still maps the old board
  EXPECT_TRUE(ipc::Internals::summary(reader, old));
  EXPECT_TRUE(old.finished);
  EXPECT_GE(now, old.newest_time);
  replaying.join();
  ipc::Summary second;
  ASSERT_TRUE(ipc::Internals::summary(Reader(stream.name()), second));
  EXPECT_EQ(second.knots, 3U);
  EXPECT_GE(second.newest_time, old.newest_time + *options.lead + milliseconds(600));
}

}  // namespace
}  // namespace splinecast::apps
