#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "apps/mcap/format/parsed.hpp"

namespace splinecast::apps::mcap {

using Bytes = std::vector<std::byte>;

/// Appends one record to bytes, field by field. The destructor writes its length.
class Encoder {
 public:
  Encoder(Bytes& out, Opcode opcode);
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  ~Encoder();

  template <typename T>
  Encoder& number(T value) {
    return raw(std::as_bytes(std::span(&value, 1)));
  }
  Encoder& raw(std::span<const std::byte> bytes);
  /// Throws Failure if the text has 4 GiB or more.
  Encoder& string(std::string_view text);
  Encoder& pairs(const Pairs& pairs);
  Encoder& counts(const std::map<std::uint16_t, std::uint64_t>& counts);

 private:
  Bytes& out_;
  std::size_t begin_;  ///< of the record in `out_`
};

// Append a record.

void append_header(Bytes& out, std::string_view profile, std::string_view library);
void append_schema(Bytes& out, const SchemaFields& schema);
void append_channel(Bytes& out, const ChannelFields& channel);
void append_metadata(Bytes& out, std::string_view name, const Pairs& values);
void append_statistics(Bytes& out, const Statistics& statistics);

/// Appends a message. A negative time becomes 0, because a file has no negative times. Allocates
/// only if `out` has to grow.
void append_message(Bytes& out, const MessageFields& message);

}  // namespace splinecast::apps::mcap
