#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string_view>

#include "apps/mcap/input/channels.hpp"
#include "apps/mcap/input/decompressor.hpp"
#include "apps/mcap/output/file_writer.hpp"

namespace splinecast::apps::mcap {

/// What the end of a damaged file says of its content.
struct FileEnd {
  std::map<std::uint16_t, Record> schemas;
  std::map<std::uint16_t, Record> channels;
  std::optional<std::uint64_t> messages;  ///< their number in the file
  /// Whether the checksum of all data is right; nothing if there is none.
  std::optional<bool> is_data_right;
};

/// A complete file that is made of the whole records of another one. Each function throws
/// InputError if the record cannot be read, and then leaves it out.
class RecoveredFile {
 public:
  RecoveredFile(const Source& file, const FileEnd& end, Write write, std::string_view profile)
      : file_(file), end_(end), writer_(std::move(write), profile) {}

  /// Copies a record that is outside of chunks. Leaves out what a new summary replaces, and unknown
  /// records other than those of applications.
  void take(const Record& record);
  void finish();

  [[nodiscard]] const Statistics& statistics() noexcept { return writer_.summary().statistics(); }
  [[nodiscard]] bool failed() const noexcept { return writer_.failed(); }

 private:
  void take_message(const Record& record);
  void take_chunk(const Record& record);
  void take_metadata(const Record& record);
  void take_attachment(const Record& record);
  void take_raw(const Record& record);
  bool describe(const Source& source, const Record& record);
  void require_schema(std::uint16_t id, Bytes& out);
  void require_channel(const Source& source, const Record& message, std::uint16_t id, Bytes& out);
  void index_record(const Source& source, const Record& record);
  void end_loose_chunk();

  Source file_;  ///< the damaged one
  const FileEnd& end_;
  FileWriter writer_;
  Decompressor decompressor_;
  DescriptionMemory memory_;
  Channels channels_;       ///< those that the new file has so far
  MessageIndexes indexes_;  ///< of the chunk that is copied
  Bytes described_;         ///< the schemas and channels that are new in this chunk
  Bytes missing_;           ///< those that it needs and that only the summary has
  // Records that were outside of chunks.
  Bytes loose_;
  bool has_chunks_ = false;
  MessageIndexes loose_indexes_;
};

}  // namespace splinecast::apps::mcap
