#include "apps/mcap/format/encoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "apps/process/exit_codes.hpp"

namespace splinecast::apps::mcap {
namespace {

std::uint64_t timestamp(Time time) {
  return static_cast<std::uint64_t>(std::max(time, Time::zero()).count());
}

}  // namespace

Encoder::Encoder(Bytes& out, Opcode opcode) : out_(out), begin_(out.size()) {
  out_.resize(begin_ + kRecordHeader);
  out_[begin_] = static_cast<std::byte>(opcode);
}

Encoder::~Encoder() {
  const std::uint64_t size = out_.size() - begin_ - kRecordHeader;
  std::memcpy(out_.data() + begin_ + 1, &size, sizeof size);
}

Encoder& Encoder::raw(std::span<const std::byte> bytes) {
  out_.insert(out_.end(), bytes.begin(), bytes.end());
  return *this;
}

Encoder& Encoder::string(std::string_view text) {
  if (text.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw Failure(fmt::format("a text of {} bytes is too long for MCAP", text.size()));
  }
  number(static_cast<std::uint32_t>(text.size()));
  return raw(std::as_bytes(std::span(text)));
}

Encoder& Encoder::pairs(const Pairs& pairs) {
  std::uint64_t size = 0;
  for (const auto& [key, value] : pairs) size += 8 + key.size() + value.size();
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    throw Failure(fmt::format("metadata of {} bytes is too long for MCAP", size));
  }
  number(static_cast<std::uint32_t>(size));
  for (const auto& [key, value] : pairs) string(key).string(value);
  return *this;
}

Encoder& Encoder::counts(const std::map<std::uint16_t, std::uint64_t>& counts) {
  number(static_cast<std::uint32_t>(10 * counts.size()));
  for (const auto& [id, count] : counts) number(id).number(count);
  return *this;
}

void append_header(Bytes& out, std::string_view profile, std::string_view library) {
  Encoder(out, Opcode::header).string(profile).string(library);
}

void append_schema(Bytes& out, const SchemaFields& schema) {
  Encoder(out, Opcode::schema)
      .number(schema.id)
      .string(schema.name)
      .string(schema.encoding)
      .string(schema.data);
}

void append_channel(Bytes& out, const ChannelFields& channel) {
  Encoder(out, Opcode::channel)
      .number(channel.id)
      .number(channel.schema)
      .string(channel.topic)
      .string(channel.message_encoding)
      .pairs(channel.metadata);
}

void append_metadata(Bytes& out, std::string_view name, const Pairs& values) {
  Encoder(out, Opcode::metadata).string(name).pairs(values);
}

void append_statistics(Bytes& out, const Statistics& statistics) {
  Encoder(out, Opcode::statistics)
      .number(statistics.messages)
      .number(statistics.schemas)
      .number(statistics.channels)
      .number(statistics.attachments)
      .number(statistics.metadata)
      .number(statistics.chunks)
      .number(statistics.start_time)
      .number(statistics.end_time)
      .counts(statistics.messages_of_channel);
}

void append_message(Bytes& out, const MessageFields& message) {
  Encoder(out, Opcode::message)
      .number(message.channel)
      .number(message.sequence)
      .number(timestamp(message.log_time))
      .number(timestamp(message.publish_time))
      .raw(message.data);
}

}  // namespace splinecast::apps::mcap
