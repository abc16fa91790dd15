#include <gtest/gtest.h>

#include <bit>

#include "tests/apps/mcap/record_bytes.hpp"
#include "tests/apps/mcap/recording.hpp"
#include "tests/fixtures/processes/allocations.hpp"
#include "tests/fixtures/processes/built_with.hpp"

/// Files of the writer, byte by byte, compared with records that are put together as
/// https://mcap.dev/spec describes them.
namespace splinecast::testing {
namespace {

namespace mcap = apps::mcap;

/// The expected file of WritesEachRecordAsSpecified, part by part.
struct Expected {
  std::string schema = record(3, u16(1) + text("point") + text("jsonschema") + text("{}"));
  std::string channel =
      record(4, u16(0) + u16(1) + text("/arm") + text("json") + u32(12) + text("k") + text("val"));
  std::string first = record(5, u16(0) + u32(7) + u64(30) + u64(5) + "abc");
  std::string second = record(5, u16(0) + u32(8) + u64(20) + u64(0) + "");
  std::string records = schema + channel + first + second;
  std::string chunk = record(6, u64(20) + u64(30) + u64(records.size()) + u32(crc32(records)) +
                                    text("") + u64(records.size()) + records);
  std::string index = record(7, u16(0) + u32(32) + u64(30) + u64((schema + channel).size()) +
                                    u64(20) + u64((schema + channel + first).size()));
  std::string metadata = record(0x0C, text("stream") + u32(18) + text("name") + text("robot1"));

  [[nodiscard]] std::string statistics() const {
    return record(0x0B, u64(2) + u16(1) + u32(1) + u32(0) + u32(1) + u32(1) + u64(20) + u64(30) +
                            u32(10) + u16(0) + u64(2));
  }
  [[nodiscard]] std::string chunk_index(std::size_t at) const {
    return record(8, u64(20) + u64(30) + u64(at) + u64(chunk.size()) + u32(10) + u16(0) +
                         u64(at + chunk.size()) + u64(index.size()) + text("") +
                         u64(records.size()) + u64(records.size()));
  }
};

std::string with_data_end(const std::string& data) { return data + record(0x0F, u32(crc32(data))); }

/// The data section with its summary, whose records are grouped as given.
std::string with_summary(const std::string& data,
                         const std::vector<std::pair<char, std::string>>& groups) {
  std::string summary;
  std::string offsets;
  for (const auto& [opcode, records] : groups) {
    offsets += record(0x0E, opcode + u64(data.size() + summary.size()) + u64(records.size()));
    summary += records;
  }
  const std::string checked =
      summary + offsets + '\x02' + u64(20) + u64(data.size()) + u64(data.size() + summary.size());
  return data + checked + u32(crc32(checked)) + kMagicText;
}

TEST(McapWriter, WritesEachRecordAsSpecified) {
  REQUIRE_MCAP();
  MemoryFileWriter out({.profile = "p", .compression = mcap::Compression::none});
  const auto schema = out.writer.add_schema("point", "jsonschema", "{}");
  const auto channel = out.writer.add_channel(schema, "/arm", "json", {{"k", "val"}});
  EXPECT_EQ(schema, 1);
  EXPECT_EQ(channel, 0);
  out.writer.write(channel, 7, Time(30), Time(5), bytes_of("abc"));
  out.writer.write(channel, 8, Time(20), Time(-4), {});
  out.writer.add_metadata("stream", {{"name", "robot1"}});
  out.writer.finish();

  const mcap::Reader reader("file", bytes_of(out.file));
  const std::string begin = kMagicText + record(1, text("p") + text(reader.library()));
  const Expected expected;
  const std::string data = begin + expected.chunk + expected.index + expected.metadata;
  const std::string metadata_index =
      record(0x0D, u64((begin + expected.chunk + expected.index).size()) +
                       u64(expected.metadata.size()) + text("stream"));
  EXPECT_EQ(out.file, with_summary(with_data_end(data), {{3, expected.schema},
                                                         {4, expected.channel},
                                                         {0x0B, expected.statistics()},
                                                         {8, expected.chunk_index(begin.size())},
                                                         {0x0D, metadata_index}}));
}

TEST(McapWriter, WritesSchemasAndChannelsOnceBeforeTheirFirstMessageAndUnusedOnesAtTheEnd) {
  REQUIRE_MCAP();
  MemoryFileWriter out({.profile = "", .compression = mcap::Compression::none});
  const auto schema = out.writer.add_schema("s", "", "");
  const auto a = out.writer.add_channel(schema, "/a", "");
  const auto b = out.writer.add_channel(schema, "/b", "");
  out.writer.add_channel(0, "/unused", "");
  out.writer.write(a, 0, Time(0), Time(0), {});
  out.writer.end_chunk();
  out.writer.end_chunk();  // an empty chunk is not written
  out.writer.write(b, 0, Time(0), Time(0), {});
  out.writer.write(a, 0, Time(0), Time(0), {});
  out.writer.finish();
  std::vector<std::vector<int>> chunks;
  mcap::Records records({"file", bytes_of(out.file)}, mcap::kMagic.size());
  for (mcap::Record record; records.next(record);) {
    if (record.opcode != mcap::Opcode::chunk) continue;
    constexpr std::size_t kFields = 40;
    mcap::Records parts({"chunk", record.content.subspan(kFields)});
    chunks.emplace_back();
    for (mcap::Record part; parts.next(part);) {
      chunks.back().push_back(static_cast<int>(part.opcode));
    }
  }
  EXPECT_EQ(chunks, (std::vector<std::vector<int>>{{3, 4, 5}, {4, 5, 5, 4}}));
}

TEST(McapWriter, EndsAChunkAtItsSizeAndHandsItOverWhole) {
  REQUIRE_MCAP();
  std::vector<std::string> writes;
  mcap::Writer writer(
      [&](std::span<const std::byte> bytes) {
        writes.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        return true;
      },
      {.profile = "", .compression = mcap::Compression::none, .chunk_bytes = 1000});
  const auto channel = writer.add_channel(0, "/a", "");
  const std::string data(469, 'x');  // 500 bytes with the fields of a message
  for (std::uint32_t i = 0; i < 5; ++i) {
    writer.write(channel, i, Time(i), Time(i), bytes_of(data));
  }
  ASSERT_EQ(writes.size(), 3U);
  EXPECT_TRUE(writes[0].starts_with(kMagicText));
  for (const std::size_t i : {1U, 2U}) {
    mcap::Records records({"write", bytes_of(writes[i])});
    mcap::Record record;
    ASSERT_TRUE(records.next(record));
    EXPECT_EQ(record.opcode, mcap::Opcode::chunk);
    ASSERT_TRUE(records.next(record));
    EXPECT_EQ(record.opcode, mcap::Opcode::message_index);
    EXPECT_TRUE(records.is_at_end());
  }
  EXPECT_GT(writer.open_bytes(), 0U);
}

TEST(McapWriter, WritesNothingAfterAFailedWrite) {
  REQUIRE_MCAP();
  int calls = 0;
  mcap::Writer writer([&](std::span<const std::byte>) { return ++calls < 2; }, {});
  const auto channel = writer.add_channel(0, "/a", "");
  writer.write(channel, 0, Time(0), Time(0), {});
  EXPECT_FALSE(writer.failed());
  const std::uint64_t bytes = writer.bytes();
  writer.end_chunk();
  EXPECT_TRUE(writer.failed());
  for (int i = 0; i < 100; ++i) writer.write(channel, 1, Time(0), Time(0), {});
  EXPECT_EQ(writer.open_bytes(), 0U);
  writer.add_metadata("m", {});
  writer.finish();
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(writer.bytes(), bytes);
}

TEST(McapWriter, AllocatesNothingForAMessageOnceItsMemorySuffices) {
  REQUIRE_MCAP();
  mcap::Writer writer([](std::span<const std::byte>) { return true; }, {.profile = ""});
  const auto a = writer.add_channel(0, "/a", "");
  const auto b = writer.add_channel(0, "/b", "");
  const std::string data(100, 'x');
  const auto write_hundred = [&](std::uint16_t first, std::uint16_t second) {
    const std::size_t before = allocations();
    for (std::uint32_t i = 0; i < 100; ++i) {
      writer.write(i % 2 == 0 ? first : second, i, Time(i), Time(i), bytes_of(data));
    }
    const std::size_t count = allocations() - before;
    writer.end_chunk();
    return count;
  };
  write_hundred(a, b);
  EXPECT_EQ(write_hundred(a, b), 0U);
  write_hundred(b, b);
  EXPECT_EQ(write_hundred(b, b), 0U);
  // The memory of a channel without messages was freed: there may be ever new channels.
  EXPECT_GT(write_hundred(a, b), 0U);
}

TEST(McapWriter, RefusesMoreSchemasThanNumbers) {
  REQUIRE_MCAP();
  MemoryFileWriter out({});
  for (int i = 1; i <= 65535; ++i) EXPECT_EQ(out.writer.add_schema("s", "", ""), i);
  EXPECT_THROW(out.writer.add_schema("s", "", ""), apps::Failure);
  EXPECT_THROW(MemoryFileWriter({}).writer.add_channel(1, "/a", ""), apps::Failure);
}

}  // namespace
}  // namespace splinecast::testing
