#include "apps/mcap/format/parsed.hpp"

#include <fmt/format.h>

#include "apps/mcap/format/checksum.hpp"

namespace splinecast::apps::mcap {
namespace {

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};  // NOLINT(*-reinterpret-cast)
}

/// A reader copies a record of this kind: its size has a bound.
FieldReader description(const Source& source, const Record& record, std::string_view kind) {
  if (record.content.size() > kMostDescription) {
    source.refuse(record.offset, fmt::format("a {} record of {} bytes is larger than {} bytes",
                                             kind, record.content.size(), kMostDescription));
  }
  return {source, record};
}

}  // namespace

SchemaFields parse_schema(const Source& source, const Record& record) {
  FieldReader fields = description(source, record, "schema");
  SchemaFields schema;
  schema.id = fields.number<std::uint16_t>();
  schema.name = fields.string();
  schema.encoding = fields.string();
  schema.data = text_of(fields.bytes<std::uint32_t>());
  return schema;
}

ChannelFields parse_channel(const Source& source, const Record& record) {
  FieldReader fields = description(source, record, "channel");
  ChannelFields channel;
  channel.id = fields.number<std::uint16_t>();
  channel.schema = fields.number<std::uint16_t>();
  channel.topic = fields.string();
  channel.message_encoding = fields.string();
  channel.metadata = fields.pairs();
  return channel;
}

MessageFields parse_message(const Source& source, const Record& record) {
  FieldReader fields(source, record);
  MessageFields message;
  message.channel = fields.number<std::uint16_t>();
  message.sequence = fields.number<std::uint32_t>();
  message.log_time = fields.time();
  message.publish_time = fields.time();
  message.data = fields.rest();
  return message;
}

ChunkFields parse_chunk(const Source& source, const Record& record) {
  FieldReader fields(source, record);
  ChunkFields chunk;
  chunk.start_time = fields.number<std::uint64_t>();
  chunk.end_time = fields.number<std::uint64_t>();
  chunk.uncompressed_size = fields.number<std::uint64_t>();
  chunk.uncompressed_crc = fields.number<std::uint32_t>();
  chunk.compression = fields.string();
  chunk.records = fields.bytes<std::uint64_t>();
  return chunk;
}

AttachmentFields parse_attachment(const Source& source, const Record& record) {
  FieldReader fields(source, record);
  AttachmentFields attachment;
  attachment.log_time = fields.number<std::uint64_t>();
  attachment.create_time = fields.number<std::uint64_t>();
  attachment.name = fields.string();
  attachment.media_type = fields.string();
  attachment.data_size = fields.bytes<std::uint64_t>().size();
  const std::size_t size = record.content.size() - fields.rest().size();
  const auto crc = fields.number<std::uint32_t>();
  attachment.is_whole = crc == 0 || crc == crc32_of(record.content.first(size));
  return attachment;
}

MetadataFields parse_metadata(const Source& source, const Record& record) {
  FieldReader fields = description(source, record, "metadata");
  MetadataFields metadata;
  metadata.name = fields.string();
  metadata.values = fields.pairs();
  return metadata;
}

Statistics parse_statistics(const Source& source, const Record& record) {
  FieldReader fields(source, record);
  Statistics statistics;
  statistics.messages = fields.number<std::uint64_t>();
  statistics.schemas = fields.number<std::uint16_t>();
  statistics.channels = fields.number<std::uint32_t>();
  statistics.attachments = fields.number<std::uint32_t>();
  statistics.metadata = fields.number<std::uint32_t>();
  statistics.chunks = fields.number<std::uint32_t>();
  statistics.start_time = fields.number<std::uint64_t>();
  statistics.end_time = fields.number<std::uint64_t>();
  statistics.messages_of_channel = fields.counts();
  return statistics;
}

std::optional<FooterFields> footer_of(std::span<const std::byte> file) noexcept {
  if (file.size() < kMagic.size() + kFileEnd) return std::nullopt;
  const auto end = file.last(kFileEnd);
  const bool is_footer = static_cast<Opcode>(end[0]) == Opcode::footer &&
                         load<std::uint64_t>(end.data() + 1) == kFooter - kRecordHeader;
  if (!is_footer || !has_magic(end.subspan(kFooter))) return std::nullopt;
  const std::byte* const fields = end.data() + kRecordHeader;
  return FooterFields{load<std::uint64_t>(fields), load<std::uint64_t>(fields + 8),
                      load<std::uint32_t>(fields + 16)};
}

}  // namespace splinecast::apps::mcap
