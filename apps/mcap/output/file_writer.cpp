#include "apps/mcap/output/file_writer.hpp"

#include <utility>

#include "apps/mcap/format/checksum.hpp"

namespace splinecast::apps::mcap {

FileWriter::FileWriter(Write write, std::string_view profile) : write_(std::move(write)) {
  buffer_.assign(kMagic.begin(), kMagic.end());
  append_header(buffer_, profile, "splinecast " SPLINECAST_VERSION);
  put(buffer_);
}

void FileWriter::put(std::span<const std::byte> bytes) {
  if (failed_ || bytes.empty()) return;
  failed_ = !write_(bytes);
  if (failed_) return;
  bytes_ += bytes.size();
  crc_ = crc32_of(bytes, crc_);
}

void FileWriter::write_chunk(const ChunkFields& chunk, const MessageIndexes& messages) {
  buffer_.clear();
  Encoder(buffer_, Opcode::chunk)
      .number(chunk.start_time)
      .number(chunk.end_time)
      .number(chunk.uncompressed_size)
      .number(chunk.uncompressed_crc)
      .string(chunk.compression)
      .number(std::uint64_t{chunk.records.size()})
      .raw(chunk.records);
  const RecordPlace place{bytes_, buffer_.size()};
  indexes_.clear();
  for (const std::uint16_t channel : messages.channels()) {
    const auto entries = std::as_bytes(messages.of(channel));
    const std::size_t begin = buffer_.size();
    Encoder(buffer_, Opcode::message_index)
        .number(channel)
        .number(static_cast<std::uint32_t>(entries.size()))
        .raw(entries);
    indexes_.push_back({bytes_ + begin, buffer_.size() - begin});
  }
  put(buffer_);
  if (!failed_) summary_.add_chunk(chunk, place, messages, indexes_);
}

void FileWriter::write_metadata(std::string_view name, const Pairs& values) {
  buffer_.clear();
  append_metadata(buffer_, name, values);
  const RecordPlace place = write_records(buffer_);
  if (!failed_) summary_.add_metadata(name, place);
}

RecordPlace FileWriter::write_records(std::span<const std::byte> records) {
  const RecordPlace place{bytes_, records.size()};
  put(records);
  return place;
}

void FileWriter::finish() {
  buffer_.clear();
  Encoder(buffer_, Opcode::data_end).number(crc_);
  summary_.append_to(buffer_, bytes_ + buffer_.size());
  put(buffer_);
}

}  // namespace splinecast::apps::mcap
