#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/mcap/format/compression.hpp"
#include "apps/mcap/output/compressor.hpp"
#include "apps/mcap/output/file_writer.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::mcap {

struct WriterOptions {
  std::string profile{};
  Compression compression = Compression::zstd;
  std::size_t chunk_bytes = std::size_t{1} << 20U;  ///< uncompressed size at which a chunk ends
};

/// Writes an MCAP file (https://mcap.dev/spec) for one thread: messages in chunks with checksums
/// and message indexes, and a summary with statistics and chunk indexes. A schema and a channel are
/// written before the first message that needs them, and again in the summary.
class Writer {
 public:
  using Write = mcap::Write;

  /// Writes the beginning of the file. Throws Failure if this program was built without the
  /// libraries for MCAP.
  Writer(Write write, const WriterOptions& options);

  /// Adds a schema. Returns its number, from 1. Throws Failure if there are 65535 already.
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data);

  /// Adds a channel with messages of a schema; 0: without a schema. Returns its number, from 0.
  /// Throws Failure if there are 65536 already, or if there is no such schema.
  std::uint16_t add_channel(std::uint16_t schema, std::string_view topic,
                            std::string_view message_encoding,
                            const std::map<std::string, std::string>& metadata = {});

  /// Adds a message to the open chunk, and ends the chunk if it is large enough. A negative time
  /// becomes 0, because a file has no negative times. Allocates nothing once the memory of the
  /// chunk before suffices. Throws std::out_of_range if there is no such channel.
  void write(std::uint16_t channel, std::uint32_t sequence, Time log_time, Time publish_time,
             std::span<const std::byte> data);

  /// Ends the open chunk, then writes a metadata record.
  void add_metadata(std::string_view name, const std::map<std::string, std::string>& values);

  /// Ends the open chunk, if it has any record: Write gets the chunk and its indexes at once.
  void end_chunk();

  /// Ends the open chunk and writes the end of the file. Write nothing after it.
  void finish();

  /// Whether Write has failed. Nothing is written after that.
  [[nodiscard]] bool failed() const noexcept { return file_.failed(); }
  /// Bytes that Write has taken.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return file_.bytes(); }
  /// Whether this number of further channels, and of schemas, still have numbers.
  [[nodiscard]] bool has_numbers(std::size_t count) const noexcept;
  /// Uncompressed bytes of the open chunk.
  [[nodiscard]] std::size_t open_bytes() const noexcept { return records_.size(); }

 private:
  /// A schema or channel, and whether the file has it.
  struct Description {
    Bytes record;
    std::uint16_t schema = 0;
    bool is_written = false;
  };
  void describe(Description& description);
  void describe_channel(Description& channel);

  std::size_t chunk_bytes_;
  Compression compression_;
  Compressor compressor_;
  FileWriter file_;
  std::vector<Description> schemas_;   ///< by number − 1
  std::vector<Description> channels_;  ///< by number
  Bytes records_;                      ///< of the open chunk
  MessageIndexes indexes_;             ///< of the open chunk
};

}  // namespace splinecast::apps::mcap
