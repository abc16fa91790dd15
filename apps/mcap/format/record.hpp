#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "apps/mcap/format/source.hpp"

namespace splinecast::apps::mcap {

/// The first and the last bytes of a file: `\x89MCAP0\r\n`.
inline constexpr std::array<std::byte, 8> kMagic{std::byte{0x89}, std::byte{'M'}, std::byte{'C'},
                                                 std::byte{'A'},  std::byte{'P'}, std::byte{'0'},
                                                 std::byte{'\r'}, std::byte{'\n'}};

/// Kinds of records.
enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0A,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

/// Bytes before the content of a record: opcode and length.
inline constexpr std::size_t kRecordHeader = 9;
/// Bytes of a footer record, and of the end of a complete file.
inline constexpr std::size_t kFooter = kRecordHeader + 20;
inline constexpr std::size_t kFileEnd = kFooter + kMagic.size();

/// A record of a source.
struct Record {
  Opcode opcode{};
  std::uint64_t offset = 0;  ///< of its opcode in the source
  std::span<const std::byte> content;

  /// Bytes with opcode and length.
  [[nodiscard]] std::uint64_t size() const noexcept { return kRecordHeader + content.size(); }
};

/// Iterates over the records of a source.
class Records {
 public:
  explicit Records(const Source& source, std::uint64_t offset = 0) noexcept
      : source_(source), offset_(offset) {}

  /// Takes the next record. Returns false if the rest of the source is not a whole record.
  [[nodiscard]] bool next(Record& record) noexcept;

  /// Offset of the next record.
  [[nodiscard]] std::uint64_t offset() const noexcept { return offset_; }
  [[nodiscard]] bool is_at_end() const noexcept { return offset_ == source_.bytes.size(); }
  [[nodiscard]] const Source& source() const noexcept { return source_; }

 private:
  Source source_;
  std::uint64_t offset_;  ///< at most the size of the source
};

/// Whether bytes begin with the magic of a file.
[[nodiscard]] bool has_magic(std::span<const std::byte> bytes) noexcept;

}  // namespace splinecast::apps::mcap
