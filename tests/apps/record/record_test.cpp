#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "splinecast/reader.hpp"
#include "splinecast/streams.hpp"
#include "tests/apps/record/recorded.hpp"

/// `record` beside streams of this process.
namespace splinecast::testing {
namespace {

class Record : public RecorderTest {};

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

/// Positions that are hard to write: of every magnitude, −0, the smallest and a large one.
std::vector<double> hard_position(std::size_t i) {
  static std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  if (i == 3) return {-0.0, std::numeric_limits<double>::denorm_min()};
  if (i == 4) return {0.1, 1e16 + 2};
  return {unit(random) * std::pow(10.0, static_cast<double>(i % 20) - 10), 1.0 / 3 * unit(random)};
}

TEST_F(Record, WaypointsReadBackExactlyAndEverySegmentVerifies) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name());
  const std::string path = folder.path("run.mcap");
  Process recorder = start_recorder({stream.name(), "-o", path, "--until-finished", "--json"});
  std::vector<std::vector<double>> sent;
  source.append_until(500, [&](std::size_t i) { return sent.emplace_back(hard_position(i)); });
  source.finish();
  const Ended ended = recorder.wait();
  EXPECT_EQ(ended.code, 0) << ended.err;
  const auto report = nlohmann::json::parse(ended.out);
  EXPECT_EQ(report["items"], 501);
  EXPECT_EQ(report["lost"], 0);
  const auto waypoints = messages_of(path, "/" + stream.name() + "/waypoints");
  ASSERT_EQ(waypoints.size(), 501U);
  for (std::size_t i = 0; i < sent.size(); ++i) {
    const auto& position = waypoints[i]["position"];
    EXPECT_EQ(bits(position["x"].get<double>()), bits(sent[i][0])) << i;
    EXPECT_EQ(bits(position["a \"b\""].get<double>()), bits(sent[i][1])) << i;
    EXPECT_EQ(waypoints[i]["time_ns"], static_cast<std::int64_t>(i) * 10'000'000);
    EXPECT_EQ(waypoints[i]["item"], i);
  }
  EXPECT_EQ(waypoints.back()["kind"], "finish");
  expect_verified(path, stream.name());
  EXPECT_EQ(verify(path).stream(stream.name())["segments"], 499);
}

TEST_F(Record, AnAlreadyRunningStreamVerifiesFromItsItemsOnTheRing) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name());
  source.append_until(3000);  // more than the ring has
  const std::string path = folder.path("run.mcap");
  Process recorder = start_recorder({stream.name(), "-o", path, "--until-finished"});
  recorder.await_message("'" + stream.name() + "': recording");
  source.append_until(3500);
  source.finish();
  const Ended ended = recorder.wait();
  EXPECT_EQ(ended.code, 5);
  EXPECT_NE(ended.err.find("items lost (before attaching "), std::string::npos) << ended.err;
  const auto found = verify(path);
  EXPECT_EQ(found.code, 5) << found.err;
  const auto at = found.stream(stream.name());
  EXPECT_GE(at["equal"], 1000);
  EXPECT_TRUE(at["difference"].is_null());
  const auto before = at["reasons"]["before attaching"]["items"].get<std::size_t>();
  EXPECT_GE(before, 3000 - 1024);
  EXPECT_EQ(at["items"].get<std::size_t>() + before, 3501);
  EXPECT_EQ(at["unaccounted"], 0);
}

TEST_F(Record, EventsHaveTheirCauses) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name(), {.method = find_method("hermite")});
  const std::string path = folder.path("run.mcap");
  Process recorder = start_recorder({stream.name(), "-o", path});
  recorder.await_message("'" + stream.name() + "': recording");
  source.append_until(3);  // without the velocities that the method needs
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  std::vector<std::string> kinds;
  for (const auto& event : messages_of(path, "/" + stream.name() + "/events")) {
    kinds.push_back(event["event"]);
    if (event["event"] != "refusal") continue;
    EXPECT_EQ(event["item"], kinds.size() - 3);  // after two attachments
    EXPECT_EQ(event["reason"], "lacks derivatives");
  }
  EXPECT_EQ(kinds,
            (std::vector<std::string>{"attached", "attached", "refusal", "refusal", "refusal"}));
}

TEST_F(Record, PatternsFindLateStreamsAndARecreatedStream) {
  const TestFolder folder;
  const TestStream stream;
  const std::string path = folder.path("run.mcap");
  Process recorder = start_recorder({stream.name() + "*", "-o", path});
  for (int life = 0; life < 2; ++life) {
    {
      SteppedStream source(stream.name());
      source.append_until(100);
      source.finish();
      const auto parts = [&] {
        const auto found = verify(path).stream(stream.name());
        return found.is_null() ? 0 : found["segments"].get<int>();
      };
      EXPECT_TRUE(await([&] { return parts() == 99 * (life + 1); })) << parts();
    }
    remove_stream(stream.name());
  }
  recorder.signal(SIGTERM);
  const Ended ended = recorder.wait();
  EXPECT_EQ(ended.code, 0) << ended.err;
  expect_verified(path, stream.name());
  EXPECT_EQ(verify(path).stream(stream.name())["parts"], 2);
}

TEST_F(Record, EndsWithAStreamThatIsRemovedAsSoonAsItIsFinished) {
  const TestFolder folder;
  const TestStream stream;
  const std::string path = folder.path("run.mcap");
  auto source = std::make_unique<SteppedStream>(stream.name());
  Process recorder = start_recorder({stream.name(), "-o", path, "--until-finished"});
  recorder.await_message("'" + stream.name() + "': recording");
  source->append_until(50);
  recorder.signal(SIGSTOP);
  source->finish();
  source.reset();
  remove_stream(stream.name());
  recorder.signal(SIGCONT);
  EXPECT_EQ(recorder.wait().code, 0);
  expect_verified(path, stream.name());
  EXPECT_EQ(verify(path).stream(stream.name())["segments"], 49);
}

TEST_F(Record, TakesNoLockAndMapsReadOnly) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name());
  source.append_until(20);
  Process recorder = start_recorder({stream.name(), "-o", folder.path("run.mcap")});
  recorder.await_message("'" + stream.name() + "': recording");
  const std::string process = fmt::format("/proc/{}/", recorder.pid());
  std::size_t regions = 0;
  std::ifstream maps(process + "maps");
  for (std::string line; std::getline(maps, line);) {
    if (line.find("/dev/shm/splinecast.") == std::string::npos) continue;
    ++regions;
    EXPECT_NE(line.find(" r--s "), std::string::npos) << line;
  }
  EXPECT_EQ(regions, 2U);
  for (const auto& entry : std::filesystem::directory_iterator(process + "fd")) {
    std::error_code error;
    const std::string target = std::filesystem::read_symlink(entry, error).string();
    EXPECT_EQ(target.find("splinecast." + stream.name()), std::string::npos) << target;
  }
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    EXPECT_EQ(line.find(fmt::format(" {} ", recorder.pid())), std::string::npos) << line;
  }
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
}

TEST_F(Record, StatesAreThoseOfAReader) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name());
  const std::string path = folder.path("run.mcap");
  Process recorder =
      start_recorder({stream.name(), "-o", path, "--until-finished", "--states", "250"});
  source.append_until(50);
  source.finish();
  EXPECT_EQ(recorder.wait().code, 0);
  Reader reader(stream.name(), kPatience);
  State state(2);
  const auto states = messages_of(path, "/" + stream.name() + "/states");
  ASSERT_EQ(states.size(), 123U);  // 0 to 490 ms every 4 ms
  for (const auto& sampled : states) {
    ASSERT_EQ(reader.sample(Time(sampled["time_ns"].get<std::int64_t>()), state),
              SampleStatus::settled);
    EXPECT_EQ(bits(sampled["position"]["x"]), bits(state.position()[0]));
    EXPECT_EQ(bits(sampled["acceleration"]["x"]), bits(state.acceleration()[0]));
    EXPECT_EQ(sampled["kind"], "spline");
  }
}

TEST_F(Record, StatesAreAtADefaultRateAndCanBeSwitchedOff) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name());
  source.append_until(50);
  source.finish();
  const auto count = [&](const std::string& name, std::vector<std::string> options) {
    const std::string path = folder.path(name);
    options.insert(options.begin(), {"record", stream.name(), "-o", path, "--until-finished"});
    EXPECT_EQ(run(options).code, 0);
    return messages_of(path, "/" + stream.name() + "/states").size();
  };
  EXPECT_EQ(count("default.mcap", {}), 10U);  // 0 to 450 ms every 50 ms
  EXPECT_EQ(count("off.mcap", {"--states", "0"}), 0U);
  EXPECT_EQ(run({"record", "arm", "-o", "run.mcap", "--states", "2e5"}).code, 2);
}

}  // namespace
}  // namespace splinecast::testing
