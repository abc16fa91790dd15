#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "apps/mcap/output/summary.hpp"

namespace splinecast::apps::mcap {

/// Takes the bytes of a file, in order. Returns false, with the reason in errno, if they could not
/// be written.
using Write = std::function<bool(std::span<const std::byte>)>;

/// Writes the records of a file outside of chunks, and the summary of what was written. After a
/// failed write it writes nothing more.
class FileWriter {
 public:
  /// Writes the magic and the header.
  FileWriter(Write write, std::string_view profile);

  /// The summary, to which the caller adds the schemas and channels that it writes.
  [[nodiscard]] Summary& summary() noexcept { return summary_; }

  /// Writes a chunk and the indexes of its messages, with one call of Write.
  void write_chunk(const ChunkFields& chunk, const MessageIndexes& messages);
  void write_metadata(std::string_view name, const Pairs& values);
  /// Writes records as they are. Returns their place.
  RecordPlace write_records(std::span<const std::byte> records);
  /// Writes the end of the data, the summary and the footer.
  void finish();

  [[nodiscard]] bool failed() const noexcept { return failed_; }
  /// Bytes that Write has taken.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }

 private:
  void put(std::span<const std::byte> bytes);

  Write write_;
  Summary summary_;
  Bytes buffer_;
  std::vector<RecordPlace> indexes_;
  std::uint64_t bytes_ = 0;
  std::uint32_t crc_ = 0;  ///< of all bytes so far
  bool failed_ = false;
};

}  // namespace splinecast::apps::mcap
