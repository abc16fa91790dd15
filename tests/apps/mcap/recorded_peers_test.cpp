#include <gtest/gtest.h>
#include <signal.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "tests/apps/mcap/core_peer.hpp"
#include "tests/apps/mcap/recording.hpp"
#include "tests/apps/record/recorded.hpp"

/// Files that `record` is writing, has ended, or had written when it was killed.
namespace splinecast::testing {
namespace {

constexpr std::array kNames{"none", "lz4", "zstd"};

/// A recorder of a stream. Its files are in a folder of their own.
class RecordedByProgram {
 public:
  RecordedByProgram(const std::string& compression, std::vector<std::string> options)
      : recorder_(start({stream_.name(), "-o", folder_.path("run.mcap"), "--compression",
                         compression, "--states", "50"},
                        std::move(options))) {
    recorder_.await_message("'" + stream_.name() + "': recording");
  }
  /// Sends waypoints, and waits until a file has more messages.
  void send(const std::string& file) {
    const std::size_t before = read_messages(file);
    source_.append_until(count_ += 500);
    EXPECT_TRUE(await([&] { return read_messages(file) > before; }));
  }
  void trigger() const { EXPECT_EQ(run({"record", "--trigger", std::to_string(pid())}).code, 0); }
  void end(int signal) {
    recorder_.signal(signal);
    (void)recorder_.wait();
  }
  [[nodiscard]] pid_t pid() const { return recorder_.pid(); }
  [[nodiscard]] std::string path(const std::string& file) const { return folder_.path(file); }
  [[nodiscard]] std::vector<std::string> files() const { return recordings_in(folder_.path("")); }

 private:
  static Process start(std::vector<std::string> arguments, std::vector<std::string> further) {
    arguments.insert(arguments.end(), further.begin(), further.end());
    return start_recorder(arguments);
  }
  /// Number of messages in its whole chunks; 0 if there is no file.
  [[nodiscard]] std::size_t read_messages(const std::string& file) const {
    const std::string bytes = read_file(folder_.path(file));
    return bytes.empty() ? 0 : messages_of(bytes).size();
  }

  TestFolder folder_;
  TestStream stream_;
  SteppedStream source_{stream_.name()};
  std::size_t count_ = 0;
  Process recorder_;
};

class McapPeersOfRecorder : public McapPeers {
 protected:
  void follow(RecordedByProgram& recorded, const std::string& name) const;
};

/// Checks that the peer reads the messages of a complete file that we read.
void expect_same(const nlohmann::json& read, const std::string& file) {
  const auto messages = messages_of(file);
  EXPECT_GT(messages.size(), 0U);
  EXPECT_EQ(read["indexed"]["messages"].size(), messages.size());
  EXPECT_EQ(read["stream"]["messages"], json_of(messages));
  EXPECT_EQ(read["stream"]["done"], true);
}

/// Checks that the peer reads the messages of the beginning of a file that we read.
void expect_same_beginning(const nlohmann::json& read, const std::string& file) {
  EXPECT_EQ(read["stream"]["messages"], json_of(messages_of(file)));
  EXPECT_EQ(read["stream"]["done"], false);
}

/// Compares what the peer reads of a file while it is written, of its beginning, and of all of it.
void McapPeersOfRecorder::follow(RecordedByProgram& recorded, const std::string& name) const {
  recorded.send(name);
  const std::string begun = read_file(recorded.path(name));
  EXPECT_GT(messages_of(begun).size(), 0U);
  expect_same_beginning(read_beginning(begun), begun);
  const std::string part = begun.substr(0, begun.size() * 2 / 3);
  expect_same_beginning(read_beginning(part), part);
  recorded.end(SIGINT);
  const std::string whole = read_file(recorded.path(name));
  expect_same(read(whole), whole);
}

TEST_F(McapPeersOfRecorder, ReadRecordingsWhileTheyAreWritten) {
  for (const std::string compression : kNames) {
    RecordedByProgram recorded(compression, {});
    follow(recorded, "run.mcap");
  }
}

TEST_F(McapPeersOfRecorder, ReadADumpWhileItIsWritten) {
  RecordedByProgram recorded("zstd", {"--last", "3600", "--after", "3600"});
  recorded.trigger();
  follow(recorded, "run.trigger-0001.mcap");
}

TEST_F(McapPeersOfRecorder, ReadEachFileOfARecorderThatBeginsSeveral) {
  for (const std::string compression : kNames) {
    RecordedByProgram recorded(compression, {});
    recorded.send("run.mcap");
    recorded.trigger();
    recorded.send("run-0002.mcap");
    recorded.end(SIGINT);
    const auto files = recorded.files();
    EXPECT_EQ(files.size(), 2U);
    for (const std::string& path : files) {
      const std::string file = read_file(path);
      expect_same(read(file), file);
    }
  }
}

TEST_F(McapPeersOfRecorder, ReadWhatIsRecoveredOfAKilledRecorder) {
  for (const std::string compression : kNames) {
    RecordedByProgram recorded(compression, {});
    recorded.send("run.mcap");
    recorded.end(SIGKILL);
    const std::string path = recorded.path("recovered.mcap");
    EXPECT_EQ(run({"recover", recorded.path("run.mcap"), "-o", path}).code, 0);
    const std::string file = read_file(path);
    EXPECT_EQ(messages_of(file), messages_of(read_file(recorded.path("run.mcap"))));
    expect_same(read(file), file);
  }
}

}  // namespace
}  // namespace splinecast::testing
