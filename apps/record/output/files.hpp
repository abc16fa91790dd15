#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "apps/record/output/file_names.hpp"
#include "apps/record/output/memory.hpp"
#include "apps/record/output/recording_file.hpp"
#include "apps/record/watch/batch.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

struct OutputOptions {
  std::string path{};
  FileOptions file{};
  std::optional<Time> last{};  ///< keep this much in memory, and write it on an event
  std::set<EventKind> on{};    ///< the events
  Time after{};                ///< continue after the event
  std::optional<std::uint64_t> max_bytes{};
  std::optional<std::size_t> max_files{};
};

/// What a recorder has written.
struct OutputReport {
  std::vector<std::string> files{};
  std::uint64_t bytes = 0;
  std::map<RecordKind, std::uint64_t> records{};  ///< read from the streams, by kind
  std::uint64_t lost = 0;                         ///< records that no file has
  std::size_t failures = 0;                       ///< files that could not be written to their end
};

/// The files of a recorder: one after the other, or with `last` one for each event. If a file
/// cannot be written, keeps what verification needs in memory, counts what it has to forget, and
/// begins another file as soon as that is possible. One thread uses it.
class Files {
 public:
  /// Creates the first file, or with `last` checks the folder. Throws Failure.
  explicit Files(const OutputOptions& options);
  ~Files();
  Files(const Files&) = delete;
  Files& operator=(const Files&) = delete;

  /// Writes the records of a batch, then dumps if one of its events is a trigger.
  void take(Batch&& batch);

  /// Writes what is in memory to a file of its own with `why` in its name, and continues for
  /// `after`. If it still writes such a file, only the time begins again. Without `last`: ends the
  /// file and begins another one.
  void dump(std::string_view why, Time now);

  /// What is due at a time: ends chunks and files, checks the folder, tries again after a failure.
  /// Call it several times per second.
  void tick(Time now);

  /// Ends the last file. With `last`, dumps what no dump has.
  void finish(Time now);

  [[nodiscard]] const OutputReport& report() const noexcept { return report_; }

 private:
  void take(Record record);
  bool open(const std::string& path, Time now);
  void close_file();
  void fail(const std::string& why, Time now);
  void note_whole_chunks() noexcept;
  void rotate(Time now);
  void remove_oldest();
  void count_lost(const Record& record, std::uint64_t sequence);
  void write_loss(std::uint32_t stream, Time now);

  OutputOptions options_;
  FileNames names_;
  RecordMemory memory_;
  std::unique_ptr<RecordingFile> file_;
  std::deque<std::string> own_;  ///< files that exist, oldest first
  std::string wanted_;       ///< kind of the file that could not be created; of a dump its event
  bool wants_file_ = false;  ///< whether a file should be open
  bool is_failing_ = false;  ///< whether the last one failed, which has been said
  Time dump_until_{};        ///< of an open dump
  Time opened_{};
  Time chunk_since_{};  ///< when the oldest record of the open chunk was written
  bool has_chunk_ = false;
  Time next_check_{};
  Time next_try_{};
  std::uint64_t whole_until_ = 0;  ///< records before this number are in whole chunks, or dumped
  std::map<std::uint32_t, Loss> lost_;
  OutputReport report_;
};

}  // namespace splinecast::apps::record
