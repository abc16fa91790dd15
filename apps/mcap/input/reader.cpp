#include "apps/mcap/input/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apps/mcap/format/checksum.hpp"
#include "apps/mcap/input/chunk.hpp"

namespace splinecast::apps::mcap {

bool is_mcap(std::span<const std::byte> file) noexcept {
  const std::size_t size = std::min(file.size(), kMagic.size());
  return size > 0 && std::ranges::equal(file.first(size), std::span(kMagic).first(size));
}

Reader::Reader(std::string name, std::span<const std::byte> file)
    : name_(std::move(name)), file_{name_, file}, footer_(footer_of(file)), records_(file_) {
  require_mcap();
  if (!file.empty() && !is_mcap(file)) file_.refuse(0, "this is not an MCAP file");
  if (footer_) file_.bytes = file.first(file.size() - kMagic.size());
  read_header();
  if (footer_ && footer_->summary_start != 0) read_summary();
  rewind();
}

/// Reads the header. A file that is cut off before its end has no message.
void Reader::read_header() {
  if (file_.bytes.size() < kMagic.size()) return;
  Records records(file_, kMagic.size());
  Record header;
  if (!records.next(header)) {
    if (footer_) file_.refuse(records.offset(), "the header goes beyond the end of the file");
    return;
  }
  if (header.opcode != Opcode::header) {
    file_.refuse(header.offset, "the file does not begin with a header record");
  }
  FieldReader fields(file_, header);
  profile_ = fields.string();
  library_ = fields.string();
}

void Reader::rewind() {
  const std::size_t begin = std::min(kMagic.size(), file_.bytes.size());
  records_ = Records(file_, begin);
  chunk_.reset();
  number_ = 0;
  crc_ = crc32_of(file_.bytes.first(begin));
  is_at_end_ = false;
}

bool Reader::next(Message& message) {
  Record record;
  Source source;
  while (next_record(record, source)) {
    if (take(source, record, message)) return true;
  }
  return false;
}

/// Takes the next record of the open chunk or of the file.
bool Reader::next_record(Record& record, Source& source) {
  if (chunk_ && next_in_chunk(record, source)) return true;
  if (is_at_end_) return false;
  const bool is_whole = records_.next(record);
  if (!is_whole && footer_) {
    file_.refuse(records_.offset(), "a record goes beyond the end of the file");
  }
  // What a crash leaves may end in zeros.
  const bool is_cut = !is_whole || (!footer_ && record.opcode == Opcode{});
  is_at_end_ = is_cut || record.opcode == Opcode::data_end || record.opcode == Opcode::footer;
  if (is_cut) return false;
  source = file_;
  return true;
}

bool Reader::next_in_chunk(Record& record, Source& source) {
  source = chunk_->source();
  if (chunk_->next(record)) return true;
  if (!chunk_->is_at_end()) {
    source.refuse(chunk_->offset(), "a record goes beyond the end of the chunk");
  }
  chunk_.reset();
  return false;
}

/// Takes a record of the data section or of a chunk. Returns whether it is a message.
bool Reader::take(const Source& source, const Record& record, Message& message) {
  if (record.opcode == Opcode{}) source.refuse(record.offset, "a record has the opcode 0");
  if (record.opcode == Opcode::schema) channels_.add_schema(source, record, memory_);
  if (record.opcode == Opcode::channel) channels_.add_channel(source, record, memory_);
  if (!source.chunk) take_from_data(record);
  if (record.opcode != Opcode::message) return false;
  const MessageFields fields = parse_message(source, record);
  const Channel* const channel = channels_.find(fields.channel);
  if (channel == nullptr) {
    source.refuse(record.offset,
                  fmt::format("a message has the unknown channel {}", fields.channel));
  }
  message = {channel,     fields.sequence, fields.log_time, fields.publish_time,
             fields.data, ++number_};
  return true;
}

/// Takes what is special to records outside of chunks.
void Reader::take_from_data(const Record& record) {
  if (record.opcode == Opcode::data_end) return require_data_crc(record);
  crc_ = crc32_of(file_.bytes.subspan(record.offset, record.size()), crc_);
  if (record.opcode == Opcode::metadata) add_metadata(record);
  if (record.opcode != Opcode::chunk) return;
  const ChunkFields chunk = parse_chunk(file_, record);
  chunk_.emplace(open_chunk(file_, record, chunk, decompressor_));
}

void Reader::require_data_crc(const Record& data_end) {
  const auto crc = FieldReader(file_, data_end).number<std::uint32_t>();
  if (crc == 0 || crc == crc_) return;
  file_.refuse(data_end.offset,
               fmt::format("the data has the CRC {:#010x}, but {:#010x} is recorded", crc_, crc));
}

void Reader::add_metadata(const Record& record) {
  if (metadata_offsets_.contains(record.offset)) return;
  MetadataFields fields = parse_metadata(file_, record);
  memory_.take(file_, record, record.content.size(), fields.values.size());
  metadata_offsets_.insert(record.offset);
  metadata_.push_back({std::string(fields.name), std::move(fields.values)});
}

}  // namespace splinecast::apps::mcap
