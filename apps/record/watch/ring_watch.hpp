#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "apps/record/format/loss.hpp"
#include "apps/record/format/messages.hpp"
#include "apps/record/watch/batch.hpp"
#include "apps/record/watch/stream_times.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/ring/reader.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// Reads the items of a ring, as a passive observer. One thread uses it.
class RingWatch {
 public:
  /// Begins with the oldest item that the ring still has; those before it are lost.
  /// `times`: of the stream; outlives this.
  RingWatch(std::uint32_t number, ipc::CheckedRegion<ipc::RingLayout> ring,
            const StreamTimes& times);

  [[nodiscard]] const ipc::RegionHeader& header() const noexcept { return ring_.header; }
  [[nodiscard]] bool calls() const noexcept {
    return reader_.written() != next_ || reader_.retired();
  }
  [[nodiscard]] bool is_retired() const noexcept { return reader_.retired(); }

  /// Reads the new items into the batch, and what was overwritten before that as a loss. Returns
  /// whether there is one.
  bool look(Batch& batch);
  /// Whether the last look read so much of the ring that the next one should not wait.
  [[nodiscard]] bool is_filled_fast() const noexcept { return is_filled_fast_; }

  /// The number after the newest item that has been read.
  [[nodiscard]] ipc::Word next() const noexcept { return next_; }

  /// All items from this number on are in the record, up to the newest one.
  [[nodiscard]] ipc::Word complete_from() const noexcept { return complete_from_; }
  /// The items before this number are no longer needed: their runs have ended.
  void forget_before(ipc::Word item) noexcept;
  /// The record lacks something about the items before this number.
  void set_incomplete_before(ipc::Word item) noexcept;

  /// The first waypoint of the run that begins with `run_item` which is later than `time`, or the
  /// number after the last item if there is none yet. Empty if the record may lack it. Do not call
  /// it with a lower run or an earlier time than before.
  [[nodiscard]] std::optional<ipc::Word> first_after(ipc::Word run_item, Time time);

  /// The solver has refused an item.
  void note_refused(ipc::Word item) noexcept;
  /// The first waypoint at a time, from `run_item` on, that was not refused; empty if it is not
  /// known.
  [[nodiscard]] std::optional<ipc::Word> waypoint_at(ipc::Word run_item, Time time) const noexcept;

  /// The epoch and the process id of the present owner, from the region.
  [[nodiscard]] std::pair<ipc::Word, ipc::Word> owner() const noexcept;

 private:
  struct OpenItem {
    ipc::Word number;
    Time time;
    bool is_refused = false;
  };

  void put_item(Batch& batch);

  std::uint32_t number_;
  ipc::CheckedRegion<ipc::RingLayout> ring_;
  ipc::WaypointRingReader reader_;
  const StreamTimes& times_;
  ipc::RingItem item_;
  ipc::Word old_until_;  ///< items before this number were there before
  ipc::Word next_ = 0;
  ipc::Word complete_from_ = 0;
  bool has_any_ = false;  ///< whether an item has been read
  bool is_filled_fast_ = false;
  std::deque<OpenItem> open_;  ///< waypoints that may not have settled
};

/// The epoch of a region's owner, and the process id of that owner or of a later one.
[[nodiscard]] std::pair<ipc::Word, ipc::Word> owner_of(std::span<const std::byte> region) noexcept;

}  // namespace splinecast::apps::record
