#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <set>
#include <string>

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
  EXPECT_EQ(run({"record", "--trigger", name}).code, 0);
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
