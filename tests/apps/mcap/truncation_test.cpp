#include <gtest/gtest.h>

#include "tests/apps/mcap/recording.hpp"
#include "tests/fixtures/processes/built_with.hpp"

namespace splinecast::testing {
namespace {

namespace mcap = apps::mcap;

class McapTruncation : public ::testing::TestWithParam<mcap::Compression> {
 protected:
  void SetUp() override { REQUIRE_MCAP(); }
};

INSTANTIATE_TEST_SUITE_P(Compressions, McapTruncation,
                         ::testing::Values(mcap::Compression::none, mcap::Compression::lz4,
                                           mcap::Compression::zstd));

std::size_t count_until(const std::vector<std::size_t>& ends, std::size_t size) {
  return static_cast<std::size_t>(
      std::ranges::count_if(ends, [=](std::size_t end) { return end <= size; }));
}

std::vector<KeptMessage> first_messages(const SmallRecording& recording, std::size_t count) {
  return {recording.messages.begin(),
          recording.messages.begin() + static_cast<std::ptrdiff_t>(count)};
}

TEST_P(McapTruncation, AtEveryByteTheReaderGivesExactlyTheMessagesOfWholeChunks) {
  const SmallRecording recording(GetParam());
  const auto chunks = ends_of(recording.file, mcap::Opcode::chunk);
  ASSERT_EQ(chunks.size(), 3U);
  for (std::size_t size = 0; size < recording.file.size(); ++size) {
    const std::string part = recording.file.substr(0, size);
    mcap::Reader reader("part", bytes_of(part));
    EXPECT_TRUE(reader.ended_early()) << size;
    EXPECT_EQ(rest_of(reader), first_messages(recording, 3 * count_until(chunks, size))) << size;
  }
}

TEST_P(McapTruncation, AtEveryByteRecoveryMakesACompleteFileOfTheWholePart) {
  const SmallRecording recording(GetParam());
  const auto chunks = ends_of(recording.file, mcap::Opcode::chunk);
  const auto metadata = ends_of(recording.file, mcap::Opcode::metadata);
  for (std::size_t size = 0; size < recording.file.size(); ++size) {
    const std::string part = recording.file.substr(0, size);
    const Recovered recovered = recover_text(part);
    const std::size_t messages = 3 * count_until(chunks, size);
    EXPECT_FALSE(recovered.report.was_complete) << size;
    EXPECT_TRUE(recovered.report.damages.empty()) << size << recovered.report.damages.front();
    EXPECT_EQ(recovered.report.kept.messages, messages) << size;
    mcap::Reader reader("recovered", bytes_of(recovered.file));
    EXPECT_FALSE(reader.ended_early()) << size;
    ASSERT_TRUE(reader.statistics()) << size;
    EXPECT_EQ(reader.statistics()->messages, messages) << size;
    EXPECT_EQ(reader.metadata().size(), count_until(metadata, size)) << size;
    EXPECT_EQ(rest_of(reader), first_messages(recording, messages)) << size;
  }
}

TEST_P(McapTruncation, RecoveryOfAWholeFileKeepsEveryMessageAndLosesNothing) {
  const SmallRecording recording(GetParam());
  const Recovered recovered = recover_text(recording.file);
  EXPECT_TRUE(recovered.report.is_whole());
  EXPECT_EQ(recovered.report.lost_bytes, 0U);
  EXPECT_EQ(recovered.report.lost_messages, 0U);
  // The same writer: the same bytes.
  EXPECT_EQ(recovered.file, recording.file);
}

TEST_P(McapTruncation, ZerosAfterTheCutAreNotADamage) {
  const SmallRecording recording(GetParam());
  const auto chunks = ends_of(recording.file, mcap::Opcode::chunk);
  const std::string part = recording.file.substr(0, chunks[1]) + std::string(4096, '\0');
  mcap::Reader reader("part", bytes_of(part));
  EXPECT_TRUE(reader.ended_early());
  EXPECT_EQ(rest_of(reader), first_messages(recording, 6));
}

}  // namespace
}  // namespace splinecast::testing
