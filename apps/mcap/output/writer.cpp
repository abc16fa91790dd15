#include "apps/mcap/output/writer.hpp"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "apps/mcap/format/checksum.hpp"
#include "apps/process/exit_codes.hpp"

namespace splinecast::apps::mcap {
namespace {

constexpr std::size_t kMostNumber = std::numeric_limits<std::uint16_t>::max();

/// The number of the next schema or channel.
std::uint16_t next_number(std::size_t number, std::string_view kind) {
  if (number > kMostNumber) throw Failure(fmt::format("an MCAP file has no more {} numbers", kind));
  return static_cast<std::uint16_t>(number);
}

}  // namespace

Writer::Writer(Write write, const WriterOptions& options)
    : chunk_bytes_(options.chunk_bytes),
      compression_(options.compression),
      compressor_(options.compression),
      file_(std::move(write), options.profile) {}

std::uint16_t Writer::add_schema(std::string_view name, std::string_view encoding,
                                 std::string_view data) {
  const SchemaFields schema{next_number(schemas_.size() + 1, "schema"), name, encoding, data};
  Description description;
  append_schema(description.record, schema);
  schemas_.push_back(std::move(description));
  file_.summary().add_schema(schema);
  return schema.id;
}

std::uint16_t Writer::add_channel(std::uint16_t schema, std::string_view topic,
                                  std::string_view message_encoding,
                                  const std::map<std::string, std::string>& metadata) {
  if (schema > schemas_.size()) throw Failure(fmt::format("there is no schema {}", schema));
  const ChannelFields channel{next_number(channels_.size(), "channel"), schema, topic,
                              message_encoding, metadata};
  Description description{.record = {}, .schema = schema};
  append_channel(description.record, channel);
  channels_.push_back(std::move(description));
  file_.summary().add_channel(channel);
  return channel.id;
}

bool Writer::has_numbers(std::size_t count) const noexcept {
  return channels_.size() + count <= kMostNumber + 1 && schemas_.size() + count <= kMostNumber;
}

void Writer::describe(Description& description) {
  if (description.is_written) return;
  records_.insert(records_.end(), description.record.begin(), description.record.end());
  description.is_written = true;
}

void Writer::describe_channel(Description& channel) {
  if (channel.is_written) return;
  if (channel.schema != 0) describe(schemas_[channel.schema - 1U]);
  describe(channel);
}

void Writer::write(std::uint16_t channel, std::uint32_t sequence, Time log_time, Time publish_time,
                   std::span<const std::byte> data) {
  if (failed()) return;
  describe_channel(channels_.at(channel));
  indexes_.add(channel, log_time, records_.size());
  append_message(records_, {channel, sequence, log_time, publish_time, data});
  if (records_.size() >= chunk_bytes_) end_chunk();
}

void Writer::add_metadata(std::string_view name, const std::map<std::string, std::string>& values) {
  end_chunk();
  file_.write_metadata(name, values);
}

void Writer::end_chunk() {
  if (records_.empty()) return;
  if (!failed()) {
    const ChunkFields chunk{indexes_.start_time(), indexes_.end_time(),
                            records_.size(),       crc32_of(records_),
                            word_of(compression_), compressor_.compress(records_)};
    file_.write_chunk(chunk, indexes_);
  }
  records_.clear();
  indexes_.clear();
}

void Writer::finish() {
  for (Description& schema : schemas_) describe(schema);
  for (Description& channel : channels_) describe(channel);
  end_chunk();
  file_.finish();
}

}  // namespace splinecast::apps::mcap
