#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "tests/apps/mcap/recording.hpp"
#include "tests/fixtures/processes/built_with.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::testing {
namespace {

namespace mcap = apps::mcap;
using nlohmann::json;

class McapRecover : public ::testing::Test {
 protected:
  void SetUp() override {
    REQUIRE_MCAP();
    recording_.emplace(mcap::Compression::zstd);
  }

  /// A file with one changed byte in the content of its first, second or third chunk.
  [[nodiscard]] std::string with_damaged_chunk(std::size_t number) const {
    std::string file = recording_->file;
    file.at(ends_of(file, mcap::Opcode::chunk).at(number) - 1) ^= 1;
    return file;
  }

  [[nodiscard]] std::vector<KeptMessage> without(std::size_t chunk) const {
    std::vector<KeptMessage> messages = recording_->messages;
    const auto begin = messages.begin() + static_cast<std::ptrdiff_t>(3 * chunk);
    messages.erase(begin, begin + 3);
    return messages;
  }

  std::optional<SmallRecording> recording_;
  TestFolder folder_;
};

TEST_F(McapRecover, LeavesOutADamagedChunkAndCountsIt) {
  for (const std::size_t chunk : {0U, 1U, 2U}) {
    const Recovered recovered = recover_text(with_damaged_chunk(chunk));
    EXPECT_TRUE(recovered.report.was_complete);
    EXPECT_EQ(recovered.report.lost_chunks, 1U);
    EXPECT_EQ(recovered.report.lost_messages, 3U);
    EXPECT_EQ(recovered.report.damages.size(), 1U);
    // The first chunk describes both channels: they are then taken from the summary.
    EXPECT_EQ(messages_of(recovered.file), without(chunk));
  }
}

TEST_F(McapRecover, ContinuesAtTheNextChunkAfterAWrongLength) {
  for (const std::size_t number : {0U, 1U}) {
    std::string file = recording_->file;
    const std::size_t end = ends_of(file, mcap::Opcode::chunk).at(number);
    for (const std::size_t length : {std::size_t{3}, file.size()}) {
      file.at(end + 1) = static_cast<char>(length);  // of the message index after the chunk
      file.at(end + 2) = static_cast<char>(length >> 8U);
      const Recovered recovered = recover_text(file);
      EXPECT_FALSE(recovered.report.is_whole());
      EXPECT_EQ(recovered.report.lost_messages, 0U) << length;
      EXPECT_EQ(messages_of(recovered.file), recording_->messages) << length;
    }
  }
}

TEST_F(McapRecover, LosesTheMessagesOfAChannelThatNothingDescribes) {
  std::string file = with_damaged_chunk(0);
  file.resize(file.size() - 1);  // without the magic the summary is not found
  const Recovered recovered = recover_text(file);
  EXPECT_FALSE(recovered.report.was_complete);
  EXPECT_FALSE(recovered.report.lost_messages);
  EXPECT_EQ(recovered.report.lost_chunks, 3U);
  EXPECT_EQ(recovered.report.damages.size(), 3U);
  EXPECT_EQ(recovered.report.kept.metadata, 1U);
  mcap::Reader reader("recovered", bytes_of(recovered.file));
  EXPECT_FALSE(reader.ended_early());
}

TEST_F(McapRecover, TheVerbWritesAFileNextToTheDamagedOneAndReports) {
  const std::string path =
      folder_.write("run.mcap", recording_->file.substr(0, recording_->file.size() - 1));
  const Ended ended = run({"recover", path});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.out, "");
  EXPECT_NE(ended.err.find("run.mcap: is cut off: it has no footer"), std::string::npos)
      << ended.err;
  EXPECT_NE(ended.err.find("kept 9 messages of 2 channels in 3 chunks"), std::string::npos)
      << ended.err;
  EXPECT_EQ(read_file(folder_.path("run.recovered.mcap")), recording_->file);
}

TEST_F(McapRecover, TheVerbReportsAsJson) {
  const std::string path = folder_.write("run.mcap", with_damaged_chunk(1));
  const std::string output = folder_.path("out.mcap");
  const Ended ended = run({"recover", path, "-o", output, "--json"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json report = json::parse(ended.out);
  EXPECT_EQ(report["file"], path);
  EXPECT_EQ(report["output"], output);
  EXPECT_EQ(report["was_whole"], false);
  EXPECT_EQ(report["was_cut_off"], false);
  EXPECT_EQ(report["kept"]["messages"], 6);
  EXPECT_EQ(report["lost"]["chunks"], 1);
  EXPECT_EQ(report["lost"]["messages"], 3);
  EXPECT_EQ(report["damages"].size(), 1U);
  EXPECT_EQ(messages_of(read_file(output)), without(1));
}

TEST_F(McapRecover, TheVerbRefusesOtherFilesAndItsInputAsOutputAndLeavesThemAsTheyAre) {
  const std::string text = folder_.write("text.csv", "t,x\n0,1\n");
  const std::string output = folder_.write("output.mcap", "old");
  Ended ended = run({"recover", text, "-o", output});
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("text.csv: byte 0: this is not an MCAP file"), std::string::npos)
      << ended.err;
  EXPECT_EQ(read_file(output), "old");
  const std::string path = folder_.write("run.mcap", recording_->file);
  ended = run({"recover", path, "-o", path});
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("it would be overwritten"), std::string::npos) << ended.err;
  EXPECT_EQ(read_file(path), recording_->file);
  EXPECT_EQ(run({"recover", "-"}).code, 2);
  EXPECT_EQ(run({"recover", folder_.path("missing.mcap")}).code, 2);
  EXPECT_EQ(run({"recover", path, "-o", "/nonexistent/x.mcap"}).code, 1);
}

}  // namespace
}  // namespace splinecast::testing
