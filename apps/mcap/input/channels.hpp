#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "apps/mcap/format/parsed.hpp"

namespace splinecast::apps::mcap {

/// A channel of a file with its schema. Its address and its texts stay valid as long as the reader.
struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;  ///< 0: no schema; the other fields of the schema are then empty
  std::string topic;
  std::string message_encoding;
  std::string_view schema_name;  ///< channels share the memory of a schema
  std::string_view schema_encoding;
  std::string_view schema_data;
  std::map<std::string, std::string> metadata;
};

/// Memory for the copies of schemas, channels and metadata of a file: at most 32 MiB.
class DescriptionMemory {
 public:
  /// Counts a copy with this many bytes of text and this many keys. Throws InputError if the memory
  /// is used up.
  void take(const Source& source, const Record& record, std::size_t bytes, std::size_t keys);

 private:
  std::size_t used_ = 0;
};

/// The schemas and channels of a file.
class Channels {
 public:
  /// Add the schema or channel of a record, unless it is known. Return whether it was new. Throw
  /// InputError if another one has its number, or if the schema of a channel is unknown.
  bool add_schema(const Source& source, const Record& record, DescriptionMemory& memory);
  bool add_channel(const Source& source, const Record& record, DescriptionMemory& memory);

  /// The channel with this number, or null.
  [[nodiscard]] const Channel* find(std::uint16_t id) const noexcept {
    return id < by_id_.size() ? by_id_[id] : nullptr;
  }
  [[nodiscard]] const std::deque<Channel>& all() const noexcept { return channels_; }

 private:
  struct Schema {
    std::string name;
    std::string encoding;
    std::string data;
  };
  std::map<std::uint16_t, Schema> schemas_;
  std::deque<Channel> channels_;
  std::vector<const Channel*> by_id_;
};

}  // namespace splinecast::apps::mcap
