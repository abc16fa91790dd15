#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "apps/record/format/loss.hpp"
#include "apps/record/format/record.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// The accounts of a recorder's streams: of each item and each segment, whether it is in a file. An
/// item is counted once, also if it is read or written again. One thread uses it.
class Accounts {
 public:
  /// Streams with losses that are named in the report.
  static constexpr std::size_t kMostNamed = 20;

  /// Counts a record that has been read. Notes in it whether it was counted.
  void add(Record& record);

  /// A record that was counted will be in no file. `stream_id`: of its stream; 0: of the present
  /// one of its number. `was_wanted`: a file should have it.
  void forget(const Record& record, ipc::Word stream_id, bool was_wanted);

  /// Adds the accounts of streams that have ended, and had no record since `oldest`, to the total.
  void end(std::uint32_t stream) noexcept;
  void tidy(Time oldest);

  /// The account of a stream, if it has changed since the last call or `is_needed`.
  [[nodiscard]] const Account* changed(std::uint32_t stream, bool is_needed);
  /// The numbers of the streams whose accounts have changed.
  [[nodiscard]] std::vector<std::uint32_t> all_changed() const;

  /// The sum of all.
  [[nodiscard]] Account total() const;
  /// A line for each of the first kMostNamed streams with losses.
  [[nodiscard]] std::vector<std::string> losses() const;

 private:
  struct Stream {
    std::string name{};
    ipc::Word id = 0;
    Account account{};
    ipc::Word segments_before = 0;  ///< of earlier boards of the same stream
    bool has_solver = false;
    bool has_ended = false;
    bool is_changed = false;
    Time newest{};
  };
  void begin(Stream& stream, const Record& options);
  void retire(const Stream& stream);

  std::map<std::uint32_t, Stream> streams_;
  Account ended_;  ///< of the streams that are no longer in streams_
  std::vector<std::string> ended_losses_;
};

}  // namespace splinecast::apps::record
