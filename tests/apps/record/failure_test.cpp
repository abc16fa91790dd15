#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "apps/files/text_file.hpp"
#include "apps/mcap/input/reader.hpp"
#include "apps/mcap/output/writer.hpp"
#include "apps/record/format/messages.hpp"
#include "apps/record/verification/recorded_stream.hpp"
#include "tests/apps/record/recorded.hpp"

/// Failures of the disk and of the recorder, and files that have been changed.
namespace splinecast::testing {
namespace {

class RecordFailure : public RecorderTest {};

TEST_F(RecordFailure, AFileThatCannotGrowEndsWithAWholeChunkAndAnotherOneFollows) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name());
  // The file may have 2 MiB: more than the records of a second, with which another file begins.
  Process recorder("/usr/bin/prlimit",
                   {"--fsize=2097152", SPLINECAST_PROGRAM, "record", stream.name(), "-o",
                    folder.path("run.mcap"), "--compression", "none", "--states", "0", "--json"});
  recorder.await_message("'" + stream.name() + "': recording");
  std::size_t count = 0;
  std::thread source_thread([&] {
    while (!std::filesystem::exists(folder.path("run-0002.mcap")) && count < 60'000) {
      source.append_until(count += 20);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));  // a rate, not a wait
    }
  });
  recorder.await_message("File too large");
  recorder.await_message("recording continues in");
  source_thread.join();
  recorder.signal(SIGINT);
  const Ended ended = recorder.wait();
  const auto report = nlohmann::json::parse(ended.out);
  EXPECT_EQ(ended.code, report["lost"] == 0 ? 0 : 1);
  EXPECT_GE(report["failures"], 1);
  for (const std::string& path : recordings_in(folder.path(""))) {
    EXPECT_LE(std::filesystem::file_size(path), 2097152U);
    expect_verified(path, stream.name());
  }
}

TEST_F(RecordFailure, AVanishedFolderIsReportedAndRecordingContinuesWhenItIsBack) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name());
  std::filesystem::create_directory(folder.path("here"));
  Process recorder = start_recorder({stream.name(), "-o", folder.path("here/run.mcap")});
  recorder.await_message("'" + stream.name() + "': recording");
  source.append_until(100);
  EXPECT_TRUE(await([&] {  // a chunk has been written
    const auto found = verify(folder.path("here/run.mcap")).stream(stream.name());
    return !found.is_null() && found["equal"] > 0;
  }));
  std::filesystem::rename(folder.path("here"), folder.path("gone"));
  recorder.await_message("moved or removed");
  source.append_until(200);
  std::filesystem::create_directory(folder.path("here"));
  recorder.await_message("recording continues in");
  source.append_until(300);
  source.finish();
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  expect_verified(folder.path("gone/run.mcap"), stream.name());
  expect_verified(folder.path("here/run-0002.mcap"), stream.name());
}

/// Preloads a library that stops writes while a file exists.
TEST_F(RecordFailure, ASlowDiskCostsRecordsWhichAreCountedButNoTimeOfTheStream) {
  const TestFolder folder;
  const TestStream stream;
  constexpr std::size_t kMany = std::size_t{1} << 18U;  // its records exceed the queue
  SteppedStream source(stream.name(), {.capacity = kMany}, kMany);
  const std::string block = folder.write("block", "");
  const std::string path = folder.path("run.mcap");
  Process recorder("/usr/bin/env", {std::string("LD_PRELOAD=") + SPLINECAST_SLOW_DISK_LIBRARY,
                                    "SPLINECAST_SLOW_DISK=" + block, SPLINECAST_PROGRAM, "record",
                                    stream.name(), "-o", path, "--json"});
  recorder.await_message("'" + stream.name() + "': recording");
  source.append_until(kMany - 100);
  recorder.await_message("the disk is too slow");
  std::filesystem::remove(block);
  source.append_until(kMany + 500);
  EXPECT_TRUE(await([&] {  // the queue has room again
    const auto found = verify(path).stream(stream.name());
    return !found.is_null() && found["lost"]["items"] > 0;
  }));
  source.append_until(kMany + 1000);
  source.finish();
  recorder.signal(SIGINT);
  const Ended ended = recorder.wait();
  EXPECT_EQ(ended.code, 5);
  const auto report = nlohmann::json::parse(ended.out);
  EXPECT_GT(report["dropped"], 1000);
  const auto found = verify(path);
  EXPECT_EQ(found.code, 5) << found.err;
  const auto at = found.stream(stream.name());
  EXPECT_TRUE(at["difference"].is_null());
  EXPECT_GT(at["equal"], 1000);
  const auto lost = at["lost"];
  EXPECT_EQ(lost["items"].get<int>() + lost["segments"].get<int>() + lost["refusals"].get<int>() +
                lost["others"].get<int>(),
            report["dropped"]);
  // Each item is in the file or lost, by the file alone.
  EXPECT_EQ(at["sent"], kMany + 1001);
  EXPECT_EQ(at["unaccounted"], 0);
  EXPECT_EQ(at["items"].get<std::size_t>() + lost["items"].get<std::size_t>(), kMany + 1001);
}

/// Kills recorders of a live stream at random times.
TEST_F(RecordFailure, WhatAKilledRecorderHasWrittenVerifies) {
  const TestFolder folder;
  Process demo({"demo", "--chaos", "--seconds", "12", "--json"});
  const std::string pattern = fmt::format("demo.{}", demo.pid());
  std::mt19937 random(3);
  int readable = 0;
  for (int kill = 0; kill < 4; ++kill) {
    const std::string path = folder.path(fmt::format("{}.mcap", kill));
    Process recorder = start_recorder({pattern, "-o", path});
    recorder.await_message("': recording");
    const auto size = std::uniform_int_distribution<std::uintmax_t>(1, 300'000)(random);
    EXPECT_TRUE(await_file(path, size));
    recorder.signal(SIGKILL);
    EXPECT_EQ(recorder.wait().signal, SIGKILL);
    const Verified found = verify(path);
    if (found.code == 2) {  // killed before the first chunk
      EXPECT_NE(found.err.find("no stream"), std::string::npos) << found.err;
      continue;
    }
    // A file of a moment may lack a place at which verification can begin.
    EXPECT_TRUE(found.code == 0 || found.code == 5) << found.err;
    EXPECT_TRUE(found.stream(pattern)["difference"].is_null()) << found.json.dump(1);
    readable += found.stream(pattern)["equal"] > 0 ? 1 : 0;
  }
  EXPECT_GE(readable, 1);
  demo.signal(SIGINT);  // it removes its stream
  (void)demo.wait();
}

TEST_F(RecordFailure, StarvationReplacementsAndTakeoversVerifyBitForBit) {
  const TestFolder folder;
  const std::string path = folder.path("run.mcap");
  Process demo({"demo", "--chaos", "--seconds", "8", "--json"});
  const std::string stream = fmt::format("demo.{}", demo.pid());
  Process recorder = start_recorder({stream, "-o", path, "--json"});
  const Ended ended = demo.wait();
  EXPECT_EQ(ended.code, 0) << ended.out;
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  const Verified found = verify(path);
  EXPECT_EQ(found.code, 0) << found.err << found.json.dump(1);
  EXPECT_GT(found.stream(stream)["equal"], 0);
  if (found.stream(stream)["late_commits"] == 0 && found.stream(stream)["lost"]["items"] == 0) {
    EXPECT_EQ(found.stream(stream)["unverified"], 0);
  }
  bool has_takeover = false;
  for (const auto& event : messages_of(path, "/" + stream + "/events")) {
    has_takeover = has_takeover || event["event"] == "takeover";
  }
  EXPECT_TRUE(has_takeover);
}

/// Writes a copy of a recording in which one bit of a segment differs.
void copy_with_another_bit(const std::string& from, const std::string& to, ipc::Word segment,
                           std::size_t dimensions) {
  const apps::TextFile file(from);
  apps::mcap::Reader reader(from, std::as_bytes(std::span(file.text())));
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(to.c_str(), "wb"), std::fclose);
  apps::mcap::Writer writer(
      [&](std::span<const std::byte> bytes) {
        return std::fwrite(bytes.data(), 1, bytes.size(), out.get()) == bytes.size();
      },
      {});
  std::map<std::uint16_t, std::uint16_t> channels;
  apps::mcap::Message message;
  while (reader.next(message)) {
    const apps::mcap::Channel& channel = *message.channel;
    if (!channels.contains(channel.id)) {
      channels[channel.id] = writer.add_channel(0, channel.topic, channel.message_encoding);
    }
    apps::record::Bytes bytes(message.data.begin(), message.data.end());
    if (channel.message_encoding == "splinecast" &&
        apps::record::kind_of(bytes) == apps::record::RecordKind::segment) {
      auto copy = apps::record::decode_segment(std::span(bytes).subspan(1), dimensions);
      if (copy.number == segment) {
        copy.coefficients[5] = std::nextafter(copy.coefficients[5], 1e300);
        bytes = apps::record::encode(copy);
      }
    }
    writer.write(channels[channel.id], message.sequence, message.log_time, message.publish_time,
                 bytes);
  }
  writer.finish();
}

/// The exact messages of a recording.
std::vector<apps::record::Bytes> exact_messages(const std::string& path) {
  const apps::TextFile file(path);
  apps::mcap::Reader reader(path, std::as_bytes(std::span(file.text())));
  std::vector<apps::record::Bytes> found;
  apps::mcap::Message message;
  while (reader.next(message)) {
    if (message.channel->message_encoding != "splinecast") continue;
    found.emplace_back(message.data.begin(), message.data.end());
  }
  return found;
}

/// Changes bits of messages of a stream with replacements and takeovers: the result is a
/// difference, a refusal or, for bits without meaning, nothing; never a crash or a hang.
TEST_F(RecordFailure, AnyChangedMessagesAreVerifiedOrRefused) {
  const TestFolder folder;
  const std::string path = folder.path("run.mcap");
  Process demo({"demo", "--chaos", "--seconds", "3", "--json"});
  Process recorder = start_recorder({fmt::format("demo.{}", demo.pid()), "-o", path});
  EXPECT_EQ(demo.wait().code, 0);
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  const auto messages = exact_messages(path);
  ASSERT_GT(messages.size(), 100U);
  std::mt19937_64 random(11);
  int refused = 0;
  int different = 0;
  for (int round = 0; round < 300; ++round) {
    apps::record::RecordedStream stream;
    const std::size_t from = random() % 3 == 0 ? random() % messages.size() : 0;
    try {
      stream.take(messages.front());
      for (std::size_t i = std::max<std::size_t>(from, 1); i < messages.size(); ++i) {
        apps::record::Bytes message = messages[i];
        if (random() % messages.size() < 3) {
          message[random() % message.size()] ^= static_cast<std::byte>(1U << random() % 8);
        }
        if (random() % messages.size() != 0) stream.take(message);
      }
      stream.finish();
      different += stream.found().first ? 1 : 0;
    } catch (const apps::record::BadMessage&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 10);
  EXPECT_GT(different, 10);
}

TEST_F(RecordFailure, AChangedFileIsCaughtAndTheFirstDifferenceIsNamed) {
  const TestFolder folder;
  const TestStream stream;
  const std::string path = folder.path("run.mcap");
  SteppedStream source(stream.name());
  Process recorder = start_recorder({stream.name(), "-o", path, "--until-finished"});
  source.append_until(100);
  source.finish();
  EXPECT_EQ(recorder.wait().code, 0);
  copy_with_another_bit(path, folder.path("changed.mcap"), 42, 2);
  const Verified found = verify(folder.path("changed.mcap"));
  EXPECT_EQ(found.code, 3);
  EXPECT_EQ(found.stream(stream.name())["difference"]["segment"], 42);
  EXPECT_EQ(found.stream(stream.name())["difference"]["what"], "coefficient 2 of dimension 1");
  EXPECT_EQ(found.stream(stream.name())["equal"], 41);
  // A change that the checksums show is damage.
  std::string damaged = read_file(path);
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 4);
  EXPECT_EQ(verify(folder.write("damaged.mcap", damaged)).code, 2);
  EXPECT_EQ(verify(folder.write("no.mcap", "t,x\n0,1\n")).code, 2);
}

}  // namespace
}  // namespace splinecast::testing
