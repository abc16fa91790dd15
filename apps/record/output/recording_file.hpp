#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/mcap/output/writer.hpp"
#include "apps/record/format/json.hpp"
#include "apps/record/format/messages.hpp"
#include "apps/record/format/options.hpp"
#include "apps/record/format/record.hpp"
#include "apps/record/output/states.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// The rate at which states are recorded unless another one is given.
inline constexpr SamplingRate kStates{.hz = 20, .most = 1000};

struct FileOptions {
  mcap::Compression compression = mcap::Compression::zstd;
  SamplingRate states = kStates;  ///< of the channel of states
};

/// Device and inode of the file at a path; empty if no file is there.
using FileId = std::optional<std::pair<dev_t, ino_t>>;
[[nodiscard]] FileId file_id(const std::string& path) noexcept;

/// One file of a recorder: for each stream its channels and metadata. One thread uses it.
class RecordingFile {
 public:
  /// Creates the file, which must not exist, for its owner only (mode 0600). Throws Failure, with
  /// the system's reason.
  RecordingFile(std::string path, const FileOptions& options);
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;
  /// Closes the file. Without finish() it has no summary.
  ~RecordingFile();

  /// Adds a record to the open chunk. A stream's first record has its options. Throws BadMessage
  /// for a record that the recorder did not make.
  void write(const Record& record);
  /// The stream has ended: forgets what its messages are made with.
  void end(std::uint32_t stream) { streams_.erase(stream); }

  /// Whether the stream with this id is the file's present one of its number.
  [[nodiscard]] bool has(std::uint32_t stream, ipc::Word id) const {
    const auto found = streams_.find(stream);
    return found != streams_.end() && found->second.id == id;
  }
  /// Whether the file can have another stream.
  [[nodiscard]] bool can_begin_stream() const noexcept { return writer_->has_numbers(4); }

  /// Writes the open chunk.
  void end_chunk();
  /// Writes the open chunk and the end of the file, and closes it.
  void finish();

  /// Whether a write has failed. Then the file ends with its last whole chunk.
  [[nodiscard]] bool failed() const noexcept { return writer_->failed(); }
  /// The reason, if it has.
  [[nodiscard]] const std::string& why() const noexcept { return why_; }
  /// Whether the path still refers to this file. A system call.
  [[nodiscard]] bool is_in_place() const noexcept;
  [[nodiscard]] const FileId& id() const noexcept { return id_; }
  /// Bytes of the file, and those of the open chunk before compression.
  [[nodiscard]] std::uint64_t bytes() const noexcept {
    return writer_->bytes() + writer_->open_bytes();
  }
  [[nodiscard]] std::uint64_t written() const noexcept { return writer_->bytes(); }
  [[nodiscard]] bool has_open_chunk() const noexcept { return writer_->open_bytes() > 0; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  /// The channels of a stream, and what its messages are made with.
  struct Stream {
    Stream(const StreamOptions& options, const SamplingRate& rate);

    ipc::Word id = 0;
    std::uint16_t exact = 0, waypoints = 0, events = 0, states = 0;
    std::size_t dimensions;
    JsonMessages json;
    std::optional<States> sampled;
  };

  bool write_bytes(std::span<const std::byte> bytes);
  void cut_to_whole_chunks() noexcept;
  void write_messages(const Record& record);
  void begin_stream(const Record& record);
  std::uint16_t add_channel(const std::string& topic, std::string_view schema,
                            const std::string& text);
  void put(std::uint16_t channel, Time own_time, Time seen, std::span<const std::byte> data);
  void put(std::uint16_t channel, Time own_time, Time seen, std::string_view text);
  void put_states(Stream& stream, const Record& record);

  std::string path_;
  FileOptions options_;
  int descriptor_;
  FileId id_;
  std::string why_;
  std::unique_ptr<mcap::Writer> writer_;
  std::map<std::uint32_t, Stream> streams_;
  std::map<std::string, std::uint16_t, std::less<>> schemas_;  ///< by name and text
  std::map<std::string, std::uint16_t> channels_;              ///< by topic and schema
  std::vector<std::uint32_t> sequences_;  ///< the next sequence number of each channel
};

}  // namespace splinecast::apps::record
