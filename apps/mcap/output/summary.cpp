#include "apps/mcap/output/summary.hpp"

#include <algorithm>

#include "apps/mcap/format/checksum.hpp"

namespace splinecast::apps::mcap {
namespace {

/// Appends records of one kind to the summary, and their place to its offsets.
class Groups {
 public:
  Groups(Bytes& out, std::uint64_t begin) : out_(out), shift_(begin - out.size()) {}

  void append(Opcode opcode, const Bytes& records) {
    if (records.empty()) return;
    Encoder(offsets_, Opcode::summary_offset)
        .number(opcode)
        .number(position())
        .number(std::uint64_t{records.size()});
    out_.insert(out_.end(), records.begin(), records.end());
  }

  /// Appends the offsets of the groups. Returns where they begin in the file.
  std::uint64_t append_offsets() {
    const std::uint64_t begin = position();
    out_.insert(out_.end(), offsets_.begin(), offsets_.end());
    return begin;
  }

 private:
  [[nodiscard]] std::uint64_t position() const { return out_.size() + shift_; }

  Bytes& out_;
  Bytes offsets_;
  std::uint64_t shift_;  ///< from a position in `out_` to one in the file
};

/// Appends the footer. Its checksum is that of the bytes from `summary` to the checksum.
void append_footer(Bytes& out, std::size_t summary, std::uint64_t summary_start,
                   std::uint64_t offset_start) {
  const std::size_t begin = out.size();
  Encoder(out, Opcode::footer).number(summary_start).number(offset_start).number(std::uint32_t{0});
  const std::size_t end = begin + kFooter - sizeof(std::uint32_t);
  const std::uint32_t crc = crc32_of(std::span(out).subspan(summary, end - summary));
  std::memcpy(out.data() + end, &crc, sizeof crc);
  out.insert(out.end(), kMagic.begin(), kMagic.end());
}

}  // namespace

void Summary::add_schema(const SchemaFields& schema) {
  append_schema(schemas_, schema);
  ++statistics_.schemas;
}

void Summary::add_channel(const ChannelFields& channel) {
  append_channel(channels_, channel);
  ++statistics_.channels;
}

void Summary::add_chunk(const ChunkFields& chunk, const RecordPlace& place,
                        const MessageIndexes& messages, const std::vector<RecordPlace>& indexes) {
  std::map<std::uint16_t, std::uint64_t> offsets;
  std::uint64_t indexes_length = 0;
  const bool is_first = statistics_.messages == 0;
  for (std::size_t i = 0; i < indexes.size(); ++i) {
    const std::uint16_t channel = messages.channels()[i];
    offsets[channel] = indexes[i].offset;
    indexes_length += indexes[i].length;
    statistics_.messages += messages.of(channel).size();
    statistics_.messages_of_channel[channel] += messages.of(channel).size();
  }
  Encoder(chunk_indexes_, Opcode::chunk_index)
      .number(chunk.start_time)
      .number(chunk.end_time)
      .number(place.offset)
      .number(place.length)
      .counts(offsets)
      .number(indexes_length)
      .string(chunk.compression)
      .number(std::uint64_t{chunk.records.size()})
      .number(chunk.uncompressed_size);
  ++statistics_.chunks;
  if (indexes.empty()) return;
  statistics_.start_time =
      is_first ? chunk.start_time : std::min(statistics_.start_time, chunk.start_time);
  statistics_.end_time = std::max(statistics_.end_time, chunk.end_time);
}

void Summary::add_metadata(std::string_view name, const RecordPlace& place) {
  Encoder(metadata_indexes_, Opcode::metadata_index)
      .number(place.offset)
      .number(place.length)
      .string(name);
  ++statistics_.metadata;
}

void Summary::add_attachment(const AttachmentFields& attachment, const RecordPlace& place) {
  Encoder(attachment_indexes_, Opcode::attachment_index)
      .number(place.offset)
      .number(place.length)
      .number(attachment.log_time)
      .number(attachment.create_time)
      .number(attachment.data_size)
      .string(attachment.name)
      .string(attachment.media_type);
  ++statistics_.attachments;
}

void Summary::append_to(Bytes& out, std::uint64_t begin) const {
  const std::size_t summary = out.size();
  Bytes statistics;
  append_statistics(statistics, statistics_);
  Groups groups(out, begin);
  groups.append(Opcode::schema, schemas_);
  groups.append(Opcode::channel, channels_);
  groups.append(Opcode::statistics, statistics);
  groups.append(Opcode::chunk_index, chunk_indexes_);
  groups.append(Opcode::attachment_index, attachment_indexes_);
  groups.append(Opcode::metadata_index, metadata_indexes_);
  append_footer(out, summary, begin, groups.append_offsets());
}

}  // namespace splinecast::apps::mcap
