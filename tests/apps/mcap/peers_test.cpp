#include <gtest/gtest.h>

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "tests/apps/mcap/core_peer.hpp"
#include "tests/apps/mcap/recording.hpp"

namespace splinecast::testing {
namespace {

namespace mcap = apps::mcap;
using nlohmann::json;

/// Checks a file of SmallRecording with its first `count` messages.
void expect_read(const json& read, const SmallRecording& recording, std::size_t count) {
  const std::vector<KeptMessage> messages(
      recording.messages.begin(), recording.messages.begin() + static_cast<std::ptrdiff_t>(count));
  const json& indexed = read["indexed"];
  EXPECT_EQ(indexed["profile"], "test");
  EXPECT_EQ(indexed["messages"], json_of(messages));
  EXPECT_EQ(indexed["chunks"], count / 3);
  EXPECT_EQ(indexed["counts"], (json{{"/plain", (count + 1) / 2}, {"/described", count / 2}}));
  EXPECT_EQ(indexed["channels"][0], json::parse(R"(["/plain", "text", {}, "", "", ""])"));
  EXPECT_EQ(indexed["channels"][1], (json{"/described",
                                          "json",
                                          {{"unit", "rad"}},
                                          "waypoint",
                                          "jsonschema",
                                          hex(R"({"type":"object"})")}));
  const json metadata = json::parse(R"([["stream", {"name": "arm", "rate": "100"}]])");
  EXPECT_EQ(indexed["metadata"], metadata);
  EXPECT_EQ(read["stream"]["messages"], json_of(messages));
  EXPECT_EQ(read["stream"]["done"], true);
}

TEST_F(McapPeers, ReadEveryChannelThatWeWrite) {
  for (const auto compression : kCompressions) {
    const SmallRecording recording(compression);
    expect_read(read(recording.file), recording, 9);
  }
}

TEST_F(McapPeers, ReadEveryChannelAfterRecovery) {
  for (const auto compression : kCompressions) {
    const SmallRecording recording(compression, false);
    const Recovered recovered = recover_text(recording.file.substr(0, recording.file.size() - 1));
    ASSERT_EQ(recovered.report.kept.messages, 9U);  // the last message index is cut off
    expect_read(read(recovered.file), recording, 9);
    const std::size_t end = ends_of(recording.file, mcap::Opcode::chunk).back();
    const Recovered shorter = recover_text(recording.file.substr(0, end - 1));
    ASSERT_EQ(shorter.report.kept.messages, 6U);
    expect_read(read(shorter.file), recording, 6);
  }
}

TEST_F(McapPeers, ReadManyChunksAndChannels) {
  for (const auto compression : kCompressions) {
    MemoryFileWriter out({.profile = "", .compression = compression, .chunk_bytes = 10'000});
    std::vector<KeptMessage> written;
    for (int i = 0; i < 50; ++i) out.writer.add_channel(0, fmt::format("/{}", i), "");
    for (std::uint32_t i = 0; i < 5000; ++i) {
      const KeptMessage& message = written.emplace_back(
          KeptMessage{fmt::format("/{}", i * i % 50), i, 1'700'000'000'000'000'000 + i, i,
                      std::string(i % 40, 'x')});
      out.writer.write(static_cast<std::uint16_t>(i * i % 50), i, Time(message.log_time), Time(i),
                       bytes_of(message.data));
    }
    out.writer.finish();
    const json found = read(out.file);
    EXPECT_GT(found["indexed"]["chunks"], 20);
    EXPECT_EQ(found["indexed"]["messages"], json_of(written));
    EXPECT_EQ(found["stream"]["messages"], json_of(written));
  }
}

/// Message i of peer.mjs.
KeptMessage peer_message(std::uint32_t i) {
  constexpr std::array kTopics{"/a", "/b", "/c"};
  KeptMessage message{kTopics.at(i % 3), i, 1'700'000'000'000'000'000 + i * std::int64_t{1'000'000},
                      1'600'000'000'000'000'000 + i, ""};
  for (std::uint32_t n = 0; n < i % 17; ++n) message.data += fmt::format("message {} ", i);
  return message;
}

TEST_F(McapPeers, ReadWhatRecoveryMakesOfNothing) {
  const json found = read(recover_text("").file);
  EXPECT_EQ(found["indexed"]["messages"], json::array());
  EXPECT_EQ(found["stream"]["done"], true);
}

TEST_F(McapPeers, WriteFilesThatWeReadAndRecover) {
  constexpr std::uint32_t kCount = 1000;
  std::vector<KeptMessage> written;
  for (std::uint32_t i = 0; i < kCount; ++i) written.push_back(peer_message(i));
  for (const std::string kind : {"none", "lz4", "zstd", "unchunked"}) {
    const std::string path = folder_.path(kind + ".mcap");
    const Ended ended = peer("peer.mjs", {"write", path, kind, std::to_string(kCount)});
    ASSERT_EQ(ended.code, 0) << ended.err;
    const std::string file = read_file(path);
    mcap::Reader reader(kind, bytes_of(file));
    EXPECT_EQ(reader.metadata().size(), kind == "unchunked" ? 0 : 1) << "before the messages";
    EXPECT_EQ(rest_of(reader), written) << kind;
    EXPECT_FALSE(reader.ended_early());
    EXPECT_EQ(reader.statistics()->chunks > 1, kind != "unchunked");
    EXPECT_EQ(reader.channels().size(), 3U);
    EXPECT_EQ(reader.channels()[0].schema_data, "\x01\x02\x03");
    EXPECT_EQ(reader.channels()[2].metadata.at("topic"), "/c");
    EXPECT_EQ(reader.metadata()[0].values.at("key"), "value");
    const Recovered recovered = recover_text(file);
    EXPECT_TRUE(recovered.report.is_whole());
    EXPECT_EQ(recovered.report.kept.attachments, 1U);
    EXPECT_EQ(messages_of(recovered.file), written) << kind;
    EXPECT_EQ(read(recovered.file)["indexed"]["messages"], json_of(written)) << kind;
  }
}

}  // namespace
}  // namespace splinecast::testing
