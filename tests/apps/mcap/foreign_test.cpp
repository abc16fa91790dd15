#include <fmt/format.h>
#include <gtest/gtest.h>

#include "apps/process/exit_codes.hpp"
#include "tests/apps/mcap/record_bytes.hpp"
#include "tests/apps/mcap/recording.hpp"
#include "tests/fixtures/processes/built_with.hpp"

/// Files that other programs may write, and damaged ones, put together by hand.
namespace splinecast::testing {
namespace {

namespace mcap = apps::mcap;

class McapForeign : public ::testing::Test {
 protected:
  void SetUp() override { REQUIRE_MCAP(); }
};

const std::string kHeader = record(1, text("") + text(""));
const std::string kFooterRecord = record(2, u64(0) + u64(0) + u32(0));
const std::string kSchema = record(3, u16(1) + text("S") + text("text") + text("data"));

std::string channel(std::uint16_t id, std::uint16_t schema, const std::string& topic) {
  return record(4, u16(id) + u16(schema) + text(topic) + text("") + u32(0));
}

std::string message(std::uint16_t id, std::uint64_t time, const std::string& data) {
  return record(5, u16(id) + u32(0) + u64(time) + u64(time) + data);
}

std::string chunk(const std::string& compression, std::uint64_t size, const std::string& records) {
  return record(
      6, u64(0) + u64(0) + u64(size) + u32(0) + text(compression) + u64(records.size()) + records);
}

std::string chunk(const std::string& records) { return chunk("", records.size(), records); }

std::string file_of(const std::string& records) {
  return kMagicText + kHeader + records + kFooterRecord + kMagicText;
}

/// The data of all messages, separated by blanks.
std::string data_of(const std::string& file) {
  std::string all;
  for (const KeptMessage& m : messages_of(file)) all += m.data + " ";
  return all;
}

std::string error_of(const std::string& file) {
  try {
    (void)messages_of(file);
  } catch (const apps::InputError& error) {
    return error.what();
  }
  return "";
}

TEST_F(McapForeign, TheSmallestFileHasNoMessages) {
  const std::string file = file_of("");
  mcap::Reader reader("file", bytes_of(file));
  EXPECT_FALSE(reader.ended_early());
  EXPECT_FALSE(reader.statistics());
  EXPECT_TRUE(rest_of(reader).empty());
}

TEST_F(McapForeign, MessagesAreReadOutsideOfChunksAndInThem) {
  const std::string file =
      file_of(kSchema + channel(9, 1, "/a") + message(9, 1, "one") + message(9, 2, "two") +
              chunk(channel(9, 1, "/a") + channel(3, 0, "/b") + message(3, 0, "three")) +
              message(9, 4, "four"));
  EXPECT_EQ(data_of(file), "one two three four ");
}

TEST_F(McapForeign, OtherRecordsAndFurtherFieldsAreSkipped) {
  const std::string attachment =
      record(9, u64(1) + u64(2) + text("name") + text("type") + u64(3) + "abc" + u32(0));
  const std::string longer = record(4, u16(1) + u16(0) + text("/a") + text("") + u32(0) + "more");
  EXPECT_EQ(data_of(file_of(record(0x77, "reserved") + attachment + longer +
                            record(static_cast<char>(0x80), "") + message(1, 1, "one") +
                            chunk(record(0x55, "?") + message(1, 2, "two")))),
            "one two ");
  EXPECT_EQ(
      data_of(file_of(channel(1, 0, "/a") + record(3, u16(0) + text("") + text("") + text("")) +
                      message(1, 1, "one"))),
      "one ")
      << "a schema with the number 0 is ignored";
}

TEST_F(McapForeign, EachDamageIsNamedWithItsByte) {
  const std::string at = fmt::format("file: byte {}: ", (kMagicText + kHeader).size());
  const std::string in = "file: chunk at byte " + std::to_string((kMagicText + kHeader).size()) +
                         ", byte 0 of its records: ";
  EXPECT_EQ(error_of("not a file"), "file: byte 0: this is not an MCAP file");
  EXPECT_EQ(error_of(kMagicText + kFooterRecord + kMagicText),
            "file: byte 8: the file does not begin with a header record");
  EXPECT_EQ(error_of(file_of(message(7, 1, ""))), at + "a message has the unknown channel 7");
  EXPECT_EQ(error_of(file_of(channel(1, 5, "/a"))), at + "channel 1 has the unknown schema 5");
  EXPECT_EQ(error_of(file_of(chunk(message(7, 1, "")))),
            in + "a message has the unknown channel 7");
  EXPECT_EQ(error_of(file_of(chunk(std::string(9, '\0')))), in + "a record has the opcode 0");
  EXPECT_EQ(error_of(file_of(chunk("abc"))), in + "a record goes beyond the end of the chunk");
  EXPECT_EQ(error_of(file_of(record(4, u16(1) + u16(0) + u32(99)))),
            fmt::format("file: byte {}: a field of 99 bytes goes beyond its record, which has 0 "
                        "left",
                        (kMagicText + kHeader).size() + 9 + 8));
  EXPECT_EQ(error_of(file_of(chunk("\x1b[31m", 0, ""))),
            at + "a chunk has the unknown compression '\\x1b[31m'");
  EXPECT_EQ(
      error_of(file_of(chunk("", 5, "abc"))),
      at + "a chunk cannot be decompressed (none): the content is shorter than the chunk says");
  EXPECT_NE(error_of(file_of(chunk("zstd", 5, "abc"))).find("cannot be decompressed (zstd)"),
            std::string::npos);
  EXPECT_NE(error_of(file_of(chunk("lz4", 5, "abc"))).find("cannot be decompressed (lz4)"),
            std::string::npos);
  const std::string wrong_crc = record(6, u64(0) + u64(0) + u64(0) + u32(1) + text("") + u64(0));
  EXPECT_EQ(error_of(file_of(wrong_crc)),
            at + "a chunk has the CRC 0x00000000, but 0x00000001 is recorded");
  const std::string late = record(5, u16(1) + u32(0) + u64(std::uint64_t{1} << 63U) + u64(0));
  EXPECT_EQ(
      error_of(file_of(late + channel(1, 0, "/a"))),
      fmt::format("file: byte {}: time 9223372036854775808 ns is above 9223372036854775807 ns",
                  (kMagicText + kHeader).size() + 9 + 6));
  EXPECT_NE(error_of(file_of(record(0x0F, u32(1)))).find("the data has the CRC"),
            std::string::npos);
}

TEST_F(McapForeign, ASecondSchemaOrChannelWithTheSameNumberMustBeTheSame) {
  const std::string other = record(3, u16(1) + text("S") + text("text") + text("other"));
  EXPECT_EQ(error_of(file_of(kSchema + kSchema + channel(1, 1, "/a") + channel(1, 1, "/a"))), "");
  EXPECT_NE(error_of(file_of(kSchema + other)).find("schema 1 differs from an earlier one"),
            std::string::npos);
  EXPECT_NE(error_of(file_of(channel(1, 0, "/a") + channel(1, 0, "/b")))
                .find("channel 1 differs from an earlier one"),
            std::string::npos);
}

TEST_F(McapForeign, AChunkIsRefusedIfItSaysThatItIsHuge) {
  for (const std::string compression : {"zstd", "lz4"}) {
    const std::string error = error_of(file_of(chunk(compression, std::uint64_t{1} << 40U, "abc")));
    EXPECT_NE(error.find("has 1099511627776 bytes uncompressed, more than"), std::string::npos)
        << error;
  }
}

TEST_F(McapForeign, RecoverySearchesNoByteOftenAmongManyEndsOfData) {
  constexpr int kEnds = 500'000;
  std::string file = kMagicText + kHeader;
  for (int i = 0; i < kEnds; ++i) file += record(0x0F, u32(0));
  file += chunk(channel(1, 0, "/a") + message(1, 1, "last"));
  EXPECT_EQ(data_of(recover_text(file).file), "last ");
}

TEST_F(McapForeign, RecoveryPutsMessagesOutsideOfChunksIntoChunks) {
  const std::string loose = kSchema + channel(9, 1, "/a") + message(9, 5, "one") +
                            message(9, 2, "two") + record(static_cast<char>(0x90), "private") +
                            message(9, 4, "three");
  const Recovered recovered = recover_text(file_of(loose));
  EXPECT_TRUE(recovered.report.is_whole());
  EXPECT_EQ(recovered.report.kept.chunks, 2U);
  EXPECT_EQ(recovered.report.kept.start_time, 2U);
  EXPECT_EQ(recovered.report.kept.end_time, 5U);
  EXPECT_EQ(data_of(recovered.file), "one two three ");
  EXPECT_NE(recovered.file.find(record(static_cast<char>(0x90), "private")), std::string::npos);
  const Recovered cut = recover_text(kMagicText + kHeader + loose.substr(0, loose.size() - 1));
  EXPECT_EQ(data_of(cut.file), "one two ");
}

}  // namespace
}  // namespace splinecast::testing
