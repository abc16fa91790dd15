#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "apps/mcap/input/channels.hpp"
#include "apps/mcap/input/decompressor.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::mcap {

/// A message of a file.
struct Message {
  const Channel* channel = nullptr;
  std::uint32_t sequence = 0;
  Time log_time{};
  Time publish_time{};
  std::span<const std::byte> data;  ///< valid until the next call of the reader
  std::uint64_t number = 0;         ///< in the file, from 1
};

/// A metadata record of a file.
struct Metadata {
  std::string name;
  std::map<std::string, std::string> values;
};

/// Whether a file begins as an MCAP file does. True for a file that is cut off within its first
/// eight bytes, but not for an empty one.
[[nodiscard]] bool is_mcap(std::span<const std::byte> file) noexcept;

/// Reads an MCAP file in memory (mapped) message by message, in the order of the file, for one
/// thread. Reads files with and without chunks, indexes and summary; skips attachments and unknown
/// records. Checks every checksum that is not 0.
///
/// Needs the memory of the largest chunk, if it is compressed, and at most 64 MiB. A compressed
/// chunk has at most 1 GiB, and at most 1024 times its compressed bytes and 16 MiB.
///
/// Each function throws InputError, with file and byte offset, if the file is damaged. After that,
/// use the reader no more.
class Reader {
 public:
  /// `name` is for messages: it must be safe to print. Reads the summary, if there is one. Throws
  /// Failure if this program was built without the libraries for MCAP.
  Reader(std::string name, std::span<const std::byte> file);
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// Takes the next message. Returns false at the end of the file, or of its whole part.
  bool next(Message& message);

  /// Back to the first message.
  void rewind();

  /// Whether the file is cut off: it has no footer. next() then gives the messages of its whole
  /// chunks.
  [[nodiscard]] bool ended_early() const noexcept { return !footer_; }

  [[nodiscard]] const std::string& profile() const noexcept { return profile_; }
  /// The program that wrote the file.
  [[nodiscard]] const std::string& library() const noexcept { return library_; }

  /// Those of the summary, and those that next() has met.
  [[nodiscard]] const std::deque<Channel>& channels() const noexcept { return channels_.all(); }
  [[nodiscard]] const std::vector<Metadata>& metadata() const noexcept { return metadata_; }
  /// Those of the summary.
  [[nodiscard]] const std::optional<Statistics>& statistics() const noexcept { return statistics_; }

 private:
  void read_header();
  void read_summary();
  void read_summary_record(const Source& summary, const Record& record);
  void read_indexed_metadata(const Source& summary, const Record& record);
  void add_metadata(const Record& record);
  [[nodiscard]] bool next_record(Record& record, Source& source);
  [[nodiscard]] bool next_in_chunk(Record& record, Source& source);
  void take_from_data(const Record& record);
  void require_data_crc(const Record& data_end);
  [[nodiscard]] bool take(const Source& source, const Record& record, Message& message);

  std::string name_;
  Source file_;
  std::optional<FooterFields> footer_;
  std::string profile_;
  std::string library_;
  Channels channels_;
  std::vector<Metadata> metadata_;
  std::set<std::uint64_t> metadata_offsets_;  ///< of those in `metadata_`
  DescriptionMemory memory_;
  std::optional<Statistics> statistics_;

  Decompressor decompressor_;
  Records records_;               ///< of the file
  std::optional<Records> chunk_;  ///< records of the open chunk
  std::uint64_t number_ = 0;      ///< of the last message
  std::uint32_t crc_ = 0;         ///< of the bytes before the next record of the file
  bool is_at_end_ = false;
};

}  // namespace splinecast::apps::mcap
