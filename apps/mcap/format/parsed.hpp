#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string_view>

#include "apps/mcap/format/fields.hpp"
#include "apps/mcap/format/record.hpp"

namespace splinecast::apps::mcap {

/// The largest schema, channel or metadata record that a reader accepts.
inline constexpr std::size_t kMostDescription = std::size_t{8} << 20U;

// The records by their fields. Views are valid as long as the source.

struct SchemaFields {
  std::uint16_t id = 0;
  std::string_view name;
  std::string_view encoding;
  std::string_view data;
};

struct ChannelFields {
  std::uint16_t id = 0;
  std::uint16_t schema = 0;
  std::string_view topic;
  std::string_view message_encoding;
  Pairs metadata;
};

struct MessageFields {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  Time log_time{};
  Time publish_time{};
  std::span<const std::byte> data;
};

struct ChunkFields {
  std::uint64_t start_time = 0;  ///< earliest log time of its messages; 0 without messages
  std::uint64_t end_time = 0;    ///< latest
  std::uint64_t uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;  ///< 0: not computed
  std::string_view compression;
  std::span<const std::byte> records;  ///< compressed
};

struct AttachmentFields {
  std::uint64_t log_time = 0;
  std::uint64_t create_time = 0;
  std::string_view name;
  std::string_view media_type;
  std::uint64_t data_size = 0;
  bool is_whole = true;  ///< whether its checksum is that of its bytes, or was not computed
};

struct MetadataFields {
  std::string_view name;
  Pairs values;
};

struct FooterFields {
  std::uint64_t summary_start = 0;         ///< 0: no summary
  std::uint64_t summary_offset_start = 0;  ///< 0: no summary offsets
  std::uint32_t summary_crc = 0;           ///< 0: not computed
};

/// Counts of a whole file.
struct Statistics {
  std::uint64_t messages = 0;
  std::uint16_t schemas = 0;
  std::uint32_t channels = 0;
  std::uint32_t attachments = 0;
  std::uint32_t metadata = 0;
  std::uint32_t chunks = 0;
  std::uint64_t start_time = 0;  ///< earliest log time in ns; 0 without messages
  std::uint64_t end_time = 0;    ///< latest
  std::map<std::uint16_t, std::uint64_t> messages_of_channel;  ///< empty: not counted
};

// Parse a record of this kind. Throw InputError if a field is out of range.

[[nodiscard]] SchemaFields parse_schema(const Source& source, const Record& record);
[[nodiscard]] ChannelFields parse_channel(const Source& source, const Record& record);
[[nodiscard]] MessageFields parse_message(const Source& source, const Record& record);
[[nodiscard]] ChunkFields parse_chunk(const Source& source, const Record& record);
[[nodiscard]] AttachmentFields parse_attachment(const Source& source, const Record& record);
[[nodiscard]] MetadataFields parse_metadata(const Source& source, const Record& record);
[[nodiscard]] Statistics parse_statistics(const Source& source, const Record& record);

/// The footer of a complete file: one that ends with a footer record and the magic.
[[nodiscard]] std::optional<FooterFields> footer_of(std::span<const std::byte> file) noexcept;

}  // namespace splinecast::apps::mcap
