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
#include <utility>
#include <vector>

#include "apps/record/format/loss.hpp"
#include "apps/record/output/accounts.hpp"
#include "apps/record/output/dump_schedule.hpp"
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

/// What came of a trigger.
struct TriggerResult {
  bool is_done = false;  ///< whether its file has been begun
  std::string text{};    ///< the name of the file; else why it cannot be written now
};

/// What a recorder has written.
struct OutputReport {
  std::vector<std::string> files{};
  std::uint64_t bytes = 0;
  std::map<RecordKind, std::uint64_t> records{};  ///< read from the streams, by kind
  Account account{};                              ///< of all streams
  std::vector<std::string> losses{};              ///< of streams, in words
  std::size_t failures = 0;                       ///< files that could not be written to their end
  std::uint64_t further_events = 0;  ///< events of `on` that began no dump, because one was open
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

  /// Writes the records of a batch, then begins a dump if one of its events is of `on`: see
  /// DumpSchedule.
  void take(Batch&& batch);

  /// Begins a dump. Without `last`: ends the file and begins another one.
  TriggerResult trigger(Time now);

  /// What is due at a time: ends chunks and files, checks the folder, tries again after a failure.
  /// Call it several times per second.
  void tick(Time now);

  /// Ends the last file. With `last`, dumps what no dump has.
  void finish(Time now);

  [[nodiscard]] OutputReport report() const;

 private:
  void take(Record record);
  void take_events(const Batch& batch);
  void end_stream(std::uint32_t stream, Time now);
  void begin_dump(std::string_view why, Time now);
  void end_dump(Time now);
  [[nodiscard]] bool keeps_memory() const noexcept { return options_.last.has_value(); }
  bool open(Time now);
  void write_memory(Time now);
  bool close_file(Time now);
  void check_file(Time now);
  void end_chunk_if_due(Time now);
  void end_chunk(Time now);
  void try_again(Time now);
  void fail(const std::string& why, Time now);
  void note_whole_chunks() noexcept;
  [[nodiscard]] bool is_full() const noexcept;
  void rotate(Time now);
  void remove_oldest();
  void write(const Record& record);
  void write_losses(const Record& options, Time now);
  void write_account(const Accounts::Key& stream, Time now, bool is_needed);
  void write_accounts(Time now);
  void say_losses();
  [[nodiscard]] RecordMemory::Forget forget();

  OutputOptions options_;
  FileNames names_;
  RecordMemory memory_;
  std::unique_ptr<RecordingFile> file_;
  struct OwnFile {
    std::string path;
    FileId id;
  };
  std::deque<OwnFile> own_;  ///< files that exist, oldest first
  std::string wanted_;       ///< kind of the file that could not be created; of a dump its event
  bool wants_file_ = false;  ///< whether a file should be open
  bool is_failing_ = false;  ///< whether the last one failed, which has been said
  std::string why_;          ///< of the last failure
  bool is_part_ = false;     ///< whether the next file continues one that has what is older
  DumpSchedule dumps_;
  Time opened_{};
  std::uint64_t repeated_ = 0;  ///< bytes with which the file began
  Time chunk_since_{};          ///< when the oldest record of the open chunk was written
  bool has_chunk_ = false;
  Time next_check_{};
  Time next_tidy_{};
  Time next_try_{};
  std::uint64_t data_until_ = 0;   ///< number after the newest record that is not a summary
  std::uint64_t whole_until_ = 0;  ///< records before this number are in whole chunks, or dumped
  Accounts accounts_;
  std::map<std::pair<std::uint32_t, ipc::Word>, LossList> lost_;  ///< by stream and its id
  LossCounts said_{};                                             ///< losses that have been said
  OutputReport report_;
};

}  // namespace splinecast::apps::record
