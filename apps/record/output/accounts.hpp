#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "apps/record/format/loss.hpp"
#include "apps/record/format/record.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// The accounts of a recorder's streams: of each item and each segment, whether it is in a file. An
/// item is counted once, also if it is read or written again. A stream is known by the recorder's
/// number and by its id: a name can have several, one after the other. One thread uses it.
class Accounts {
 public:
  /// Streams with losses that are named in the report.
  static constexpr std::size_t kMostNamed = 20;

  /// Counts a record that has been read. Notes in it whether it was counted.
  void add(Record& record);

  /// Which stream: its number in the recorder, and its id.
  using Key = std::pair<std::uint32_t, ipc::Word>;

  /// A record that was counted will be in no file. `stream_id`: of its stream. `was_wanted`: a file
  /// should have it.
  void forget(const Record& record, ipc::Word stream_id, bool was_wanted);

  /// The present stream of a number has ended.
  void end(std::uint32_t stream) noexcept;
  /// Forgets the streams that have ended, had no record since `oldest` and are not `needed`.
  void tidy(Time oldest, const std::function<bool(const Key& stream)>& needed);

  /// The id of the present stream with this number; 0 if it is unknown.
  [[nodiscard]] ipc::Word present(std::uint32_t stream) const noexcept;
  /// The account of a stream, if it has changed since the last call or `is_needed`.
  [[nodiscard]] const Account* changed(const Key& stream, bool is_needed);
  /// The streams whose accounts have changed.
  [[nodiscard]] std::vector<Key> all_changed() const;

  /// The sum of all.
  [[nodiscard]] Account total() const;
  /// A line for each of the first kMostNamed streams with losses.
  [[nodiscard]] std::vector<std::string> losses() const;

 private:
  struct Stream {
    std::string name{};
    Account account{};
    ipc::Word segments_before = 0;  ///< of earlier boards of the same stream
    bool has_solver = false;
    bool has_ended = false;
    bool is_changed = false;
    Time newest{};
  };
  void begin(const Record& options);
  void retire(const Stream& stream);

  std::map<Key, Stream> streams_;
  std::map<std::uint32_t, ipc::Word> present_;  ///< ids, by number
  Account ended_;                               ///< of the streams that are no longer in streams_
  std::vector<std::string> ended_losses_;
};

}  // namespace splinecast::apps::record
