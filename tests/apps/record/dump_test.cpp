#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "apps/files/text_file.hpp"
#include "apps/mcap/input/reader.hpp"
#include "splinecast/streams.hpp"
#include "tests/apps/record/recorded.hpp"

/// Dumps, triggers and the names of files.
namespace splinecast::testing {
namespace {

class RecordDump : public RecorderTest {};

std::set<std::string> files_in(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

TEST_F(RecordDump, EachTriggerWritesAFileOfItsOwnThatVerifies) {
  const TestFolder folder;
  const TestStream stream;
  const std::string name = fmt::format("test-{}", getpid());
  SteppedStream source(stream.name());
  Process recorder = start_recorder(
      {stream.name(), "-o", folder.path("run.mcap"), "--last", "3600", "--name", name});
  recorder.await_message("'" + stream.name() + "': recording");
  source.append_until(400);
  const Ended triggered = run({"record", "--trigger", name});
  EXPECT_EQ(triggered.code, 0);
  EXPECT_EQ(triggered.out, folder.path("run.trigger-0001.mcap") + "\n");
  ASSERT_TRUE(await_file(folder.path("run.trigger-0001.mcap"), 5000));
  source.append_until(500);
  ASSERT_TRUE(await([&] {
    recorder.signal(SIGUSR1);
    return std::filesystem::exists(folder.path("run.trigger-0002.mcap"));
  }));
  EXPECT_EQ(run({"record", "--trigger", std::to_string(recorder.pid())}).code, 0);
  source.append_until(600);
  source.finish();
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  const auto files = files_in(folder.path(""));
  EXPECT_TRUE(files.contains("run.end-0001.mcap"));
  EXPECT_FALSE(files.contains("run.mcap"));
  for (const std::string& file : files) expect_verified(folder.path(file), stream.name());
  EXPECT_EQ(verify(folder.path("run.end-0001.mcap")).stream(stream.name())["segments"], 599);
  EXPECT_EQ(run({"record", "--trigger", name}).code, 4);
}

/// A dump with two streams of the same name has an account of each.
TEST_F(RecordDump, OfARecreatedStreamAccountsForEachOfTheTwo) {
  const TestFolder folder;
  const TestStream stream;
  Process recorder =
      start_recorder({stream.name(), "-o", folder.path("run.mcap"), "--last", "3600"});
  nlohmann::json found;
  const auto dump_has = [&](std::size_t items) {
    const Ended triggered = run({"record", "--trigger", std::to_string(recorder.pid())});
    found = verify(triggered.out.substr(0, triggered.out.find('\n'))).stream(stream.name());
    return !found.is_null() && found["items"] == items;
  };
  std::size_t sent = 0;
  for (const std::size_t count : {10U, 300U}) {
    {
      SteppedStream source(stream.name());
      source.append_until(count);
      source.finish();
      sent += count + 1;
      EXPECT_TRUE(await([&] { return dump_has(sent); })) << found.dump(1);
      EXPECT_EQ(found["sent"], sent);
      EXPECT_EQ(found["unaccounted"], 0);
    }
    remove_stream(stream.name());
  }
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
}

TEST_F(RecordDump, AnEventOfTheListWritesTheMemory) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name(), {.method = find_method("hermite")});
  Process recorder = start_recorder(
      {stream.name(), "-o", folder.path("run.mcap"), "--last", "60", "--on", "underrun,refusal"});
  recorder.await_message("'" + stream.name() + "': recording");
  EXPECT_TRUE(files_in(folder.path("")).empty());
  source.append_until(1);  // refused: it has no velocity
  EXPECT_TRUE(await_file(folder.path("run.refusal-0001.mcap"), 1000));
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  const auto events =
      messages_of(folder.path("run.refusal-0001.mcap"), "/" + stream.name() + "/events");
  EXPECT_EQ(events.back()["event"], "refusal");
  // No segment is there: that is not a verified curve.
  const Ended ended = run({"replay", "--verify", folder.path("run.refusal-0001.mcap")});
  EXPECT_EQ(ended.code, 5);
  EXPECT_NE(ended.err.find("nothing to verify"), std::string::npos) << ended.err;
}

/// When a recording has read the waypoints and the events of a stream: log times.
struct ReadTimes {
  ReadTimes(const std::string& path, const std::string& stream) {
    const apps::TextFile file(path);
    apps::mcap::Reader reader(path, std::as_bytes(std::span(file.text())));
    apps::mcap::Message message;
    while (reader.next(message)) {
      const std::string& topic = message.channel->topic;
      const auto* const text = reinterpret_cast<const char*>(message.data.data());  // NOLINT
      const auto json = topic.ends_with("/splinecast")
                            ? nlohmann::json()
                            : nlohmann::json::parse(text, text + message.data.size());
      if (topic == "/" + stream + "/waypoints") {
        const auto item = json["item"].get<std::uint64_t>();
        first_item = std::min(first_item, item);
        items.emplace(item, message.log_time);
        last = std::max(last, message.log_time);
      } else if (topic == "/" + stream + "/events" && json["event"] == "limit") {
        limits.emplace(json["item"].get<std::uint64_t>(), message.log_time);
      }
    }
  }
  /// Whether the file has all that was read in the time before `time`.
  [[nodiscard]] bool has_before(Time time, Time length) const {
    return first_item == 0 || items.at(first_item) <= time - length;
  }

  std::uint64_t first_item = std::numeric_limits<std::uint64_t>::max();
  std::map<std::uint64_t, Time> items{};   ///< by item
  std::map<std::uint64_t, Time> limits{};  ///< by item
  Time last{};
};

/// Appends waypoints of which many exceed a limit, at about 200 Hz for some time.
void exceed_often(SteppedStream& source, std::size_t count) {
  for (std::size_t i = 4; i <= count; i += 4) {
    source.append_until(i, [](std::size_t k) {
      const double x = k % 16 < 8 ? 1.0 : 0.0;
      return std::vector<double>{x, x};
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // a rate, not a wait
  }
}

TEST_F(RecordDump, EventsInQuickSuccessionAreInFewDumpsWithTheLastSecondsEach) {
  constexpr Time kLast = std::chrono::seconds(1);
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name(), {.limits = MotionLimits{.velocity = {1}}});
  Process recorder = start_recorder(
      {stream.name(), "-o", folder.path("run.mcap"), "--last", "1", "--on", "limit", "--json"});
  recorder.await_message("'" + stream.name() + "': recording");
  exceed_often(source, 600);
  source.finish();
  recorder.signal(SIGINT);
  const Ended ended = recorder.wait();
  EXPECT_EQ(ended.code, 0);
  const auto report = nlohmann::json::parse(ended.out);
  std::map<std::uint64_t, Time> events;
  std::vector<ReadTimes> dumps;
  for (const std::string& path : recordings_in(folder.path(""))) {
    dumps.emplace_back(path, stream.name());
    events.insert(dumps.back().limits.begin(), dumps.back().limits.end());
    if (path.find(".limit-0001") == std::string::npos) expect_verified(path, stream.name());
  }
  const Time length = events.rbegin()->second - events.begin()->second;
  EXPECT_GT(length, 2 * kLast);
  EXPECT_GE(dumps.size(), 3U);
  EXPECT_LE(dumps.size(), static_cast<std::size_t>(length / kLast) + 3);  // with that of the end
  EXPECT_EQ(events.size(), info(stream.name())["solver"]["exceeding"]);
  EXPECT_GT(report["further_events"], 50);
  for (const auto& [item, time] : events) {
    const auto has_it = [&](const ReadTimes& dump) {
      return dump.limits.contains(item) && dump.has_before(time, kLast);
    };
    EXPECT_TRUE(std::ranges::any_of(dumps, has_it)) << item;
  }
}

TEST_F(RecordDump, ContinuesAfterTheEvent) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name(), {.limits = MotionLimits{.velocity = {1}}});
  Process recorder = start_recorder({stream.name(), "-o", folder.path("run.mcap"), "--last", "60",
                                     "--on", "limit", "--after", "1"});
  recorder.await_message("'" + stream.name() + "': recording");
  source.append_until(100, [](std::size_t i) {  // one event
    return std::vector<double>{i < 50 ? 0.0 : 1.0, 0.0};
  });
  const std::string path = folder.path("run.limit-0001.mcap");
  for (std::size_t i = 110; i < 400; i += 2) {
    source.append_until(i, [](std::size_t /*i*/) { return std::vector<double>{1.0, 0.0}; });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // a rate, not a wait
  }
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  expect_verified(path, stream.name());
  const ReadTimes dump(path, stream.name());
  ASSERT_FALSE(dump.limits.empty());
  EXPECT_EQ(dump.first_item, 0U);
  EXPECT_GT(dump.items.rbegin()->first, 110U);
  EXPECT_LT(dump.items.rbegin()->first, 390U);
  EXPECT_GT(dump.last, dump.limits.rbegin()->second);
}

/// A trigger does not wait for the end of the open dump.
TEST_F(RecordDump, ATriggerWritesAFileWhileAnEventIsDumped) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name(), {.limits = MotionLimits{.velocity = {1}}});
  Process recorder = start_recorder({stream.name(), "-o", folder.path("run.mcap"), "--last", "60",
                                     "--on", "limit", "--after", "3600"});
  recorder.await_message("'" + stream.name() + "': recording");
  source.append_until(100, [](std::size_t i) {
    return std::vector<double>{i < 50 ? 0.0 : 1.0, 0};
  });
  ASSERT_TRUE(await_file(folder.path("run.limit-0001.mcap"), 5000));
  EXPECT_EQ(run({"record", "--trigger", std::to_string(recorder.pid())}).code, 0);
  ASSERT_TRUE(await_file(folder.path("run.trigger-0001.mcap"), 5000));
  source.append_until(150, [](std::size_t /*i*/) { return std::vector<double>{1.0, 0}; });
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  const std::set<std::string> expected{"run.limit-0001.mcap", "run.trigger-0001.mcap"};
  EXPECT_EQ(files_in(folder.path("")), expected);
  for (const std::string& file : expected) expect_verified(folder.path(file), stream.name());
  EXPECT_EQ(ReadTimes(folder.path("run.trigger-0001.mcap"), stream.name()).items.size(), 150U);
}

TEST_F(RecordDump, WithoutMemoryATriggerBeginsAnotherFileAndOldFilesAreRemoved) {
  const TestFolder folder;
  const TestStream stream;
  SteppedStream source(stream.name());
  Process recorder =
      start_recorder({stream.name(), "-o", folder.path("run.mcap"), "--max-files", "2"});
  recorder.await_message("'" + stream.name() + "': recording");
  for (std::size_t file = 1; file <= 4; ++file) {
    source.append_until(file * 200);
    EXPECT_EQ(run({"record", "--trigger", std::to_string(recorder.pid())}).code, 0);
    EXPECT_TRUE(await_file(folder.path(fmt::format("run-{:04}.mcap", file + 1))));
  }
  source.append_until(900);
  source.finish();
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait().code, 0);
  const std::set<std::string> expected{"run-0004.mcap", "run-0005.mcap"};
  EXPECT_EQ(files_in(folder.path("")), expected);
  for (const std::string& file : expected) expect_verified(folder.path(file), stream.name());
}

TEST_F(RecordDump, RefusesWhatCannotBe) {
  const TestFolder folder;
  const std::string path = folder.write("run.mcap", "precious");
  const auto refused = [&](const std::vector<std::string>& arguments, int code,
                           const std::string& text) {
    const Ended ended = run(arguments);
    EXPECT_EQ(ended.code, code) << ended.err;
    EXPECT_NE(ended.err.find(text), std::string::npos) << ended.err;
  };
  refused({"record", "x", "-o", path}, 1, "File exists");
  EXPECT_EQ(read_file(path), "precious");
  refused({"record", "x", "-o", folder.path("no/run.mcap")}, 1, "No such file");
  refused({"record", "x", "-o", folder.path("no/run.mcap"), "--last", "3"}, 1, "No such file");
  refused({"record", "x"}, 2, "--output");
  refused({"record", "-o", path}, 2, "STREAM");
  refused({"record", "x", "-o", path, "--on", "underrun"}, 2, "--last");
  refused({"record", "x", "-o", path, "--last", "3", "--on", "boredom"}, 2, "boredom");
  refused({"record", "x", "-o", path, "--max-size", "12"}, 2, "1MiB");
  refused({"record", "x", "-o", path, "--name", "12"}, 2, "--name");
  refused({"record", "x", "-o", path, "--compression", "rar"}, 2, "zstd");
  refused({"record", "../x", "-o", folder.path("new.mcap")}, 2, "../x");
}

}  // namespace
}  // namespace splinecast::testing
