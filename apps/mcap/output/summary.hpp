#pragma once

#include <cstdint>
#include <map>
#include <string_view>
#include <vector>

#include "apps/mcap/format/encoder.hpp"
#include "apps/mcap/format/parsed.hpp"
#include "apps/mcap/output/message_indexes.hpp"

namespace splinecast::apps::mcap {

/// A record of a file.
struct RecordPlace {
  std::uint64_t offset = 0;  ///< from the beginning of the file
  std::uint64_t length = 0;  ///< with opcode and length
};

/// What the end of a file says of its content. Grows with each chunk: about 100 bytes, and 10 for
/// each channel in it.
class Summary {
 public:
  /// Add a schema or channel of the data section, once.
  void add_schema(const SchemaFields& schema);
  void add_channel(const ChannelFields& channel);
  /// Adds a chunk. `indexes` are the places of its message index records, one for each of
  /// `messages.channels()`.
  void add_chunk(const ChunkFields& chunk, const RecordPlace& place, const MessageIndexes& messages,
                 const std::vector<RecordPlace>& indexes);
  void add_metadata(std::string_view name, const RecordPlace& place);
  void add_attachment(const AttachmentFields& attachment, const RecordPlace& place);

  [[nodiscard]] const Statistics& statistics() const noexcept { return statistics_; }

  /// Appends the summary, its offsets, the footer and the magic. `begin`: offset of the summary in
  /// the file.
  void append_to(Bytes& out, std::uint64_t begin) const;

 private:
  Statistics statistics_;
  // Records of one kind each.
  Bytes schemas_;
  Bytes channels_;
  Bytes chunk_indexes_;
  Bytes attachment_indexes_;
  Bytes metadata_indexes_;
};

}  // namespace splinecast::apps::mcap
