#include <gtest/gtest.h>
#include <signal.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include "tests/apps/record/recorded.hpp"
#include "tests/fixtures/processes/private_shared_memory.hpp"

/// Bounds of the size and number of files, and a full disk.
namespace splinecast::testing {
namespace {

class RecordDisk : public RecorderTest {};

constexpr std::uintmax_t kMiB = std::uintmax_t{1} << 20U;

/// Appends `step` waypoints every 10 ms until a condition holds. Returns how many there are.
std::size_t feed(SteppedStream& source, std::size_t count, std::size_t step,
                 const std::function<bool()>& condition) {
  constexpr std::size_t kMost = 200'000;
  while (!condition() && count < kMost) {
    source.append_until(count += step);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));  // a rate, not a wait
  }
  EXPECT_LT(count, kMost);
  return count;
}

TEST_F(RecordDisk, AFullFileIsFollowedByAnotherOneAndEachVerifies) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name());
  Process recorder =
      start_recorder({stream.name(), "-o", folder.path("run.mcap"), "--max-size", "1MiB",
                      "--max-files", "3", "--compression", "none", "--json"});
  recorder.await_message("'" + stream.name() + "': recording");
  feed(source, 0, 50, [&] { return std::filesystem::exists(folder.path("run-0004.mcap")); });
  source.finish();
  recorder.signal(SIGINT);
  const Ended ended = recorder.wait();
  EXPECT_EQ(ended.code, 0);
  const auto paths = recordings_in(folder.path(""));
  EXPECT_EQ(paths.size(), 3U);
  EXPECT_FALSE(std::filesystem::exists(folder.path("run-0001.mcap")));
  for (const std::string& path : paths) expect_verified(path, stream.name());
  EXPECT_EQ(nlohmann::json::parse(ended.out)["lost"], 0);
}

/// Verification cannot begin anywhere in a stream without a solver: its items are not repeated.
TEST_F(RecordDisk, AStreamWithoutASolverIsNotRepeatedInTheNextFile) {
  const TestFolder folder;
  const TestStream stream;
  Producer producer(stream.name(),
                    {.dimensions = 2, .clock = StreamClock::recorded, .capacity = 1U << 16U});
  Process recorder = start_recorder({stream.name(), "-o", folder.path("run.mcap"), "--max-size",
                                     "1MiB", "--compression", "none"});
  recorder.await_message("'" + stream.name() + "': recording");
  std::size_t count = 0;
  const std::array<double, 2> x{1, 2};
  while (!std::filesystem::exists(folder.path("run-0003.mcap")) && count < 60'000) {
    for (int i = 0; i < 50; ++i, ++count) {
      (void)producer.append({.time = Time(10'000'000) * count, .position = x});
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));  // a rate, not a wait
  }
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  std::size_t recorded = 0;
  for (const std::string& path : recordings_in(folder.path(""))) {
    recorded += messages_of(path, "/" + stream.name() + "/waypoints").size();
    EXPECT_EQ(verify(path).stream(stream.name())["unaccounted"], 0) << path;
  }
  EXPECT_EQ(recorded, count);
}

/// The first part of a dump has what was in memory, and the others do not repeat it.
TEST_F(RecordDisk, ALongDumpHasPartsOfABoundedSize) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name());
  Process recorder =
      start_recorder({stream.name(), "-o", folder.path("run.mcap"), "--last", "3600", "--after",
                      "3600", "--max-size", "2MiB", "--compression", "none"});
  recorder.await_message("'" + stream.name() + "': recording");
  source.append_until(1);
  const std::size_t count = 8000;
  for (std::size_t i = 1; i <= count; i += 40) {
    source.append_until(i);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));  // a rate, not a wait
  }
  EXPECT_EQ(run({"record", "--trigger", std::to_string(recorder.pid())}).code, 0);
  feed(source, count, 50,
       [&] { return std::filesystem::exists(folder.path("run.trigger-0004.mcap")); });
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  const auto paths = recordings_in(folder.path(""));
  ASSERT_GE(paths.size(), 4U);
  for (const std::string& path : paths) expect_verified(path, stream.name());
  EXPECT_GT(std::filesystem::file_size(paths[0]), 3 * kMiB);
  EXPECT_EQ(messages_of(paths[0], "/" + stream.name() + "/waypoints")[0]["item"], 0);
  for (std::size_t i = 1; i + 1 < paths.size(); ++i) {
    EXPECT_GT(messages_of(paths[i], "/" + stream.name() + "/waypoints")[0]["item"], count / 2);
  }
}

TEST_F(RecordDisk, AFullDiskIsReportedAndRecordingContinuesWhenItHasSpace) {
  REQUIRE_PRIVATE_SHARED_MEMORY();
  const PrivateSharedMemory disk("6m");
  const TestStream stream;
  constexpr std::size_t kMany = std::size_t{1} << 14U;  // a stopped recorder loses nothing
  SteppedStream source(stream.name(), {.capacity = kMany}, kMany);
  const std::string path = disk.file("run.mcap");
  { std::ofstream(disk.file("ballast")) << std::string(2 * kMiB, 'x'); }
  Process recorder = start_recorder(
      {stream.name(), "-o", path, "--compression", "none", "--states", "0", "--json"});
  recorder.await_message("'" + stream.name() + "': recording");
  const auto free = [&] { return std::filesystem::space(disk.folder()).available; };
  std::size_t count = feed(source, 0, 50, [&] { return free() < kMiB; });
  source.append_until(count += 6000);
  recorder.await_message("No space left on device");
  expect_verified(path, stream.name());  // to its last whole chunk
  EXPECT_TRUE(verify(path).json["ended_early"]);
  // The stream is not disturbed meanwhile.
  source.append_until(count += 1000);
  EXPECT_EQ(info(stream.name())["solver"]["interpolated"], count);
  std::filesystem::remove(disk.file("ballast"));
  std::filesystem::remove(path);
  recorder.await_message("recording continues in");
  source.append_until(count += 100);
  source.finish();
  recorder.signal(SIGINT);
  const Ended ended = recorder.wait();
  EXPECT_EQ(ended.code, 0) << ended.err;
  const auto report = nlohmann::json::parse(ended.out);
  EXPECT_GE(report["failures"], 1);
  EXPECT_EQ(report["lost"], 0);
  const auto paths = recordings_in(disk.folder().string());
  ASSERT_EQ(paths.size(), 1U);
  expect_verified(paths[0], stream.name());
}

/// When the disk is full at the end, records that cannot be written are counted as lost.
TEST_F(RecordDisk, AFullDiskAtTheEndIsALoss) {
  REQUIRE_PRIVATE_SHARED_MEMORY();
  const PrivateSharedMemory disk("3m");
  const TestStream stream;
  constexpr std::size_t kMany = 4096;
  SteppedStream source(stream.name(), {.capacity = kMany}, kMany);
  Process recorder = start_recorder(
      {stream.name(), "-o", disk.file("run.mcap"), "--compression", "none", "--json"});
  recorder.await_message("'" + stream.name() + "': recording");
  { std::ofstream(disk.file("ballast")) << std::string(4 * kMiB, 'x'); }
  source.append_until(3000);
  source.finish();
  recorder.await_message("No space left on device");
  recorder.signal(SIGINT);
  const Ended ended = recorder.wait();
  EXPECT_EQ(ended.code, 5) << ended.err;
  const auto report = nlohmann::json::parse(ended.out);
  EXPECT_GT(report["reasons"]["disk"]["items"], 0);
  EXPECT_EQ(report["items"].get<int>() + report["lost_items"].get<int>(), 3001);
}

/// A dump that does not fit is written when there is space.
TEST_F(RecordDisk, ADumpWaitsForSpace) {
  REQUIRE_PRIVATE_SHARED_MEMORY();
  const PrivateSharedMemory disk("2m");
  const TestStream stream;
  SteppedStream source(stream.name());
  { std::ofstream(disk.file("ballast")) << std::string(2 * kMiB - 64 * 1024, 'x'); }
  Process recorder = start_recorder({stream.name(), "-o", disk.file("run.mcap"), "--last", "3600"});
  recorder.await_message("'" + stream.name() + "': recording");
  source.append_until(1000);
  const Ended refused = run({"record", "--trigger", std::to_string(recorder.pid())});
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("it is written as soon as that is possible"), std::string::npos);
  recorder.await_message("No space left on device");
  EXPECT_TRUE(recordings_in(disk.folder().string()).empty());
  std::filesystem::remove(disk.file("ballast"));
  recorder.await_message("recording continues in");
  EXPECT_TRUE(await([&] { return verify(disk.file("run.trigger-0001.mcap")).code == 0; }));
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  EXPECT_GE(verify(disk.file("run.trigger-0001.mcap")).stream(stream.name())["equal"], 990);
}

}  // namespace
}  // namespace splinecast::testing
