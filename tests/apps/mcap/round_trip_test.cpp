#include <gtest/gtest.h>

#include <random>

#include "tests/apps/mcap/recording.hpp"
#include "tests/fixtures/processes/built_with.hpp"

namespace splinecast::testing {
namespace {

namespace mcap = apps::mcap;

class McapRoundTrip : public ::testing::TestWithParam<mcap::Compression> {
 protected:
  void SetUp() override { REQUIRE_MCAP(); }
};

INSTANTIATE_TEST_SUITE_P(Compressions, McapRoundTrip,
                         ::testing::Values(mcap::Compression::none, mcap::Compression::lz4,
                                           mcap::Compression::zstd));

TEST_P(McapRoundTrip, GivesBackEveryMessageChannelAndMetadata) {
  const SmallRecording recording(GetParam());
  mcap::Reader reader("file", bytes_of(recording.file));
  EXPECT_FALSE(reader.ended_early());
  EXPECT_EQ(reader.profile(), "test");
  EXPECT_TRUE(reader.library().starts_with("splinecast "));
  ASSERT_EQ(reader.channels().size(), 2U);
  const mcap::Channel& described = reader.channels()[1];
  EXPECT_EQ(described.topic, "/described");
  EXPECT_EQ(described.message_encoding, "json");
  EXPECT_EQ(described.schema_name, "waypoint");
  EXPECT_EQ(described.schema_encoding, "jsonschema");
  EXPECT_EQ(described.schema_data, R"({"type":"object"})");
  EXPECT_EQ(described.metadata.at("unit"), "rad");
  EXPECT_EQ(reader.channels()[0].schema_id, 0);
  EXPECT_EQ(reader.channels()[0].schema_name, "");
  EXPECT_EQ(rest_of(reader), recording.messages);
  ASSERT_EQ(reader.metadata().size(), 1U);
  EXPECT_EQ(reader.metadata()[0].name, "stream");
  EXPECT_EQ(reader.metadata()[0].values.at("rate"), "100");
}

TEST_P(McapRoundTrip, GivesTheSameMessagesAfterARewind) {
  const SmallRecording recording(GetParam());
  mcap::Reader reader("file", bytes_of(recording.file));
  mcap::Message message;
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(reader.next(message));
  EXPECT_EQ(message.number, 4U);
  reader.rewind();
  EXPECT_EQ(rest_of(reader), recording.messages);
  EXPECT_FALSE(reader.next(message));
  reader.rewind();
  EXPECT_EQ(rest_of(reader), recording.messages);
  EXPECT_EQ(reader.metadata().size(), 1U);
}

TEST_P(McapRoundTrip, CountsMessagesInTheStatistics) {
  const SmallRecording recording(GetParam());
  const mcap::Reader reader("file", bytes_of(recording.file));
  ASSERT_TRUE(reader.statistics());
  EXPECT_EQ(reader.statistics()->messages, 9U);
  EXPECT_EQ(reader.statistics()->schemas, 1U);
  EXPECT_EQ(reader.statistics()->channels, 2U);
  EXPECT_EQ(reader.statistics()->chunks, 3U);
  EXPECT_EQ(reader.statistics()->metadata, 1U);
  EXPECT_EQ(reader.statistics()->start_time, 1000U);
  EXPECT_EQ(reader.statistics()->end_time, 1008U);
  EXPECT_EQ(reader.statistics()->messages_of_channel.at(0), 5U);
  EXPECT_EQ(reader.statistics()->messages_of_channel.at(1), 4U);
}

TEST_P(McapRoundTrip, KeepsMegabytesOfRandomAndOfEqualBytes) {
  MemoryFileWriter out({.profile = "", .compression = GetParam(), .chunk_bytes = 100'000});
  const auto channel = out.writer.add_channel(0, "/bytes", "");
  std::mt19937 random(7);
  std::vector<std::string> written;
  for (std::uint32_t i = 0; i < 60; ++i) {
    std::string data(random() % 300'000, 'x');
    if (i % 2 == 0) {
      for (char& c : data) c = static_cast<char>(random());
    }
    out.writer.write(channel, i, Time(i), Time(i), bytes_of(data));
    written.push_back(std::move(data));
  }
  out.writer.finish();
  EXPECT_EQ(out.writer.bytes(), out.file.size());
  const auto messages = messages_of(out.file);
  ASSERT_EQ(messages.size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) EXPECT_EQ(messages[i].data, written[i]) << i;
}

}  // namespace
}  // namespace splinecast::testing
