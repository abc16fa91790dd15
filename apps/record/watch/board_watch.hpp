#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/record/format/loss.hpp"
#include "apps/record/format/messages.hpp"
#include "apps/record/watch/batch.hpp"
#include "apps/record/watch/returns.hpp"
#include "apps/record/watch/ring_watch.hpp"
#include "apps/record/watch/settled_excesses.hpp"
#include "core/online/sliding_window.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/law/follower.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/verification/recorded_decisions.hpp"
#include "ipc/verification/settled_segments.hpp"

namespace splinecast::apps::record {

/// Reads a board as it settles: segments, refusals, restarts, and events from the summary. One
/// thread uses it.
class BoardWatch {
 public:
  /// `ring` and `times`: of the same stream; outlive this.
  BoardWatch(std::uint32_t number, ipc::CheckedRegion<ipc::BoardLayout> board, RingWatch& ring,
             const StreamTimes& times);
  BoardWatch(const BoardWatch&) = delete;
  BoardWatch& operator=(const BoardWatch&) = delete;

  [[nodiscard]] const ipc::RegionHeader& header() const noexcept { return board_.header; }
  [[nodiscard]] bool calls() const noexcept;
  [[nodiscard]] bool is_retired() const noexcept { return reader_.retired(); }
  [[nodiscard]] bool is_finished() const noexcept { return is_finished_; }
  [[nodiscard]] std::pair<ipc::Word, ipc::Word> owner() const noexcept {
    return owner_of(board_.region.bytes());
  }

  /// Reads the ring and what has settled since the last call.
  void look(Batch& batch);

  /// The first look at a board that is older than the recorder: what it finds has occurred before.
  void look_back(Batch& batch);

  /// Writes the summary of the last look.
  void put_summary(Batch& batch);

  /// Begins a new part at the next possible place.
  void begin_again() noexcept { needs_start_ = true; }

  /// Writes an event, with further members as JSON: `"count":3`.
  void put_event(Batch& batch, EventKind kind, const std::string& members) const;

 private:
  /// Why something is lost that this look does not find.
  [[nodiscard]] LossCause cause() const noexcept {
    return summary_.revision == 0 ? LossCause::before : LossCause::overwritten;
  }
  void put_loss(Batch& batch, const Loss& loss) const;
  void put_refusals(Batch& batch);
  void put_counts(Batch& batch);
  void put_excesses(Batch& batch);
  void put_following(Batch& batch);
  void put_stops(Batch& batch);
  void put_settled_excesses(Batch& batch, const std::vector<SettledExcess>& settled) const;
  void put_segments(Batch& batch);
  void put_segment(Batch& batch, const ipc::SegmentCopy* before, const ipc::SegmentCopy& segment);
  void put_return(Batch& batch, const ipc::SegmentCopy* before, const ipc::SegmentCopy& segment);
  void put_restart(Batch& batch, Restart restart);
  void try_restart(Batch& batch, const ipc::SegmentCopy& before);
  [[nodiscard]] bool wants_start(const Batch& batch) const noexcept;
  /// `own_time`: on the wall clock.
  [[nodiscard]] Record record(RecordKind kind, ipc::Word number, Time own_time, Bytes bytes) const;
  [[nodiscard]] Time event_time(const Batch& batch) const noexcept;

  std::uint32_t number_;
  ipc::CheckedRegion<ipc::BoardLayout> board_;
  ipc::KnotBoardReader reader_;
  RingWatch& ring_;
  const StreamTimes& times_;
  core::WindowOptions options_;
  ipc::SettledSegments settled_;
  ipc::RunStarts starts_;
  Returns returns_;
  SettledExcesses excesses_;  ///< that have not settled
  ipc::Look looked_{};
  ipc::Summary summary_;   ///< of the last look
  ipc::SegmentCopy last_;  ///< the newest segment that has been read
  std::vector<ipc::RefusalRecord> refused_;
  std::map<ipc::Word, ipc::Word> stops_;  ///< last request in force of each stopper, by its id
  bool looks_back_ = false;               ///< in look_back()
  bool has_last_ = false;
  bool needs_start_ = false;
  bool is_finished_ = false;
  Time last_start_ = Time::min();
  Time last_summary_ = Time::min();
};

}  // namespace splinecast::apps::record
