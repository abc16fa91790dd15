#include "apps/mcap/input/recovered_file.hpp"

#include <fmt/format.h>

#include "apps/mcap/format/checksum.hpp"
#include "apps/mcap/input/chunk.hpp"
#include "apps/process/exit_codes.hpp"

namespace splinecast::apps::mcap {
namespace {

/// Size at which a chunk of messages that were outside of chunks ends.
constexpr std::size_t kLooseChunk = std::size_t{1} << 20U;

void append(Bytes& out, const Record& record) { Encoder(out, record.opcode).raw(record.content); }

}  // namespace

void RecoveredFile::take(const Record& record) {
  switch (record.opcode) {
    case Opcode::schema:
    case Opcode::channel:
      if (record.opcode == Opcode::channel) {
        require_schema(parse_channel(file_, record).schema, loose_);
      }
      if (describe(file_, record)) append(loose_, record);
      return;
    case Opcode::message:
      return take_message(record);
    case Opcode::chunk:
      return take_chunk(record);
    case Opcode::metadata:
      return take_metadata(record);
    case Opcode::attachment:
      return take_attachment(record);
    default:
      return take_raw(record);
  }
}

void RecoveredFile::finish() {
  end_loose_chunk();
  writer_.finish();
}

/// Adds a schema or channel to the summary. Returns whether it was new.
bool RecoveredFile::describe(const Source& source, const Record& record) {
  const bool is_schema = record.opcode == Opcode::schema;
  const bool is_new = is_schema ? channels_.add_schema(source, record, memory_)
                                : channels_.add_channel(source, record, memory_);
  if (is_new && is_schema) writer_.summary().add_schema(parse_schema(source, record));
  if (is_new && !is_schema) writer_.summary().add_channel(parse_channel(source, record));
  return is_new;
}

/// Appends a schema to `out` if the file did not have it so far, but its summary does.
void RecoveredFile::require_schema(std::uint16_t id, Bytes& out) {
  const auto schema = end_.schemas.find(id);
  if (schema != end_.schemas.end() && describe(file_, schema->second)) {
    append(out, schema->second);
  }
}

/// Appends a channel and its schema to `out`, if the file did not have it so far. Throws InputError
/// if its summary does not have it either.
void RecoveredFile::require_channel(const Source& source, const Record& message, std::uint16_t id,
                                    Bytes& out) {
  if (channels_.find(id) != nullptr) return;
  const auto channel = end_.channels.find(id);
  if (channel == end_.channels.end()) {
    source.refuse(message.offset, fmt::format("a message has the unknown channel {}", id));
  }
  const auto schema = end_.schemas.find(parse_channel(file_, channel->second).schema);
  if (schema != end_.schemas.end()) {
    describe(file_, schema->second);
    append(out, schema->second);  // again, if the file has it in the same chunk, after `out`
  }
  describe(file_, channel->second);
  append(out, channel->second);
}

/// Takes a record of a chunk.
void RecoveredFile::index_record(const Source& source, const Record& record) {
  if (record.opcode == Opcode{}) source.refuse(record.offset, "a record has the opcode 0");
  if (record.opcode == Opcode::channel) {
    require_schema(parse_channel(source, record).schema, missing_);
  }
  if (record.opcode == Opcode::schema || record.opcode == Opcode::channel) {
    if (describe(source, record)) append(described_, record);
  }
  if (record.opcode != Opcode::message) return;
  const MessageFields message = parse_message(source, record);
  require_channel(source, record, message.channel, missing_);
  indexes_.add(message.channel, message.log_time, record.offset);
}

void RecoveredFile::take_chunk(const Record& record) {
  end_loose_chunk();
  has_chunks_ = true;
  indexes_.clear();
  described_.clear();
  missing_.clear();
  ChunkFields chunk = parse_chunk(file_, record);
  try {
    Records records(open_chunk(file_, record, chunk, decompressor_));
    for (Record part; records.next(part);) index_record(records.source(), part);
    if (!records.is_at_end()) {
      records.source().refuse(records.offset(), "a record goes beyond the end of the chunk");
    }
  } catch (const InputError&) {
    // The summary has the descriptions that were read before the damage.
    writer_.write_records(missing_);
    writer_.write_records(described_);
    throw;
  }
  chunk.start_time = indexes_.start_time();
  chunk.end_time = indexes_.end_time();
  writer_.write_records(missing_);
  writer_.write_chunk(chunk, indexes_);
}

void RecoveredFile::take_message(const Record& record) {
  // One flipped bit turns a message index record into a message, which no checksum protects.
  if (has_chunks_ && !end_.is_data_right.value_or(false)) {
    file_.refuse(record.offset, "a message is outside of the chunks");
  }
  const MessageFields message = parse_message(file_, record);
  require_channel(file_, record, message.channel, loose_);
  loose_indexes_.add(message.channel, message.log_time, loose_.size());
  append(loose_, record);
  if (loose_.size() >= kLooseChunk) end_loose_chunk();
}

void RecoveredFile::end_loose_chunk() {
  if (loose_.empty()) return;
  writer_.write_chunk({loose_indexes_.start_time(), loose_indexes_.end_time(), loose_.size(),
                       crc32_of(loose_), word_of(Compression::none), loose_},
                      loose_indexes_);
  loose_.clear();
  loose_indexes_.clear();
}

void RecoveredFile::take_metadata(const Record& record) {
  const MetadataFields metadata = parse_metadata(file_, record);
  memory_.take(file_, record, record.content.size(), metadata.values.size());
  end_loose_chunk();
  writer_.write_metadata(metadata.name, metadata.values);
}

void RecoveredFile::take_attachment(const Record& record) {
  const AttachmentFields attachment = parse_attachment(file_, record);
  if (!attachment.is_whole) file_.refuse(record.offset, "an attachment has a wrong CRC");
  end_loose_chunk();
  const auto place = writer_.write_records(file_.bytes.subspan(record.offset, record.size()));
  if (!failed()) writer_.summary().add_attachment(attachment, place);
}

void RecoveredFile::take_raw(const Record& record) {
  constexpr auto kFirstOfApplications = static_cast<Opcode>(0x80);
  if (record.opcode == Opcode{}) file_.refuse(record.offset, "a record has the opcode 0");
  if (record.opcode < kFirstOfApplications) return;
  end_loose_chunk();
  writer_.write_records(file_.bytes.subspan(record.offset, record.size()));
}

}  // namespace splinecast::apps::mcap
