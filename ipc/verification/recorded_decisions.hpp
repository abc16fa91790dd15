#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "ipc/board/segment.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/verification/stream_record.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Whether a segment is an entry onto a target.
[[nodiscard]] bool is_entry(const SegmentCopy& segment) noexcept;

/// Whether a run begins with a segment that is not the first one of the stream. `run_item`: the
/// first item of the run of the segment before it.
[[nodiscard]] bool begins_run(const SegmentCopy& before, const SegmentCopy& segment,
                              std::optional<Word> run_item) noexcept;

/// What took the place of waypoints that were sent: the replacements and stops among the items of a
/// record that were taken, and the stops of stoppers, which its segments show.
class Replacements {
 public:
  /// Uses the record's items later. Allocates.
  explicit Replacements(const StreamRecord& record);

  /// The number of the first replacement from item `from` on and before item `end`; or, if that
  /// comes earlier, of the first item after a stopper's stop that was carried out after item `from`
  /// and not after item `end`.
  [[nodiscard]] std::optional<Word> find(Word from, Word end) const noexcept;

  /// The time from which on the last one before item `end` replaces.
  [[nodiscard]] std::optional<Time> time_before(Word end) const noexcept;

 private:
  /// The stop of a stopper.
  struct Stop {
    Word before;  ///< the first item after it
    Time time;
  };

  const SentItems& items_;
  std::vector<Stop> stops_;
};

/// The solver's decisions, derived from the segments of a record: which are entries, where a run
/// begins and ends. Segments are counted from 0. Changes nothing; safe from any thread.
class RecordedDecisions {
 public:
  /// The record outlives this.
  explicit RecordedDecisions(const StreamRecord& record)
      : record_(record), segments_(record.segments), replacements_(record) {}

  [[nodiscard]] const Replacements& replacements() const noexcept { return replacements_; }

  /// Whether segment i is an entry onto a target.
  [[nodiscard]] bool is_entry(std::size_t i) const noexcept { return ipc::is_entry(segments_[i]); }

  /// Whether segment i is the straight line or the stop after an entry beyond the newest waypoint.
  [[nodiscard]] bool is_after_entry(std::size_t i) const noexcept;

  /// Whether segment i is the entry by which a curve ends at its last waypoint.
  [[nodiscard]] bool is_ending(std::size_t i) const noexcept;

  /// Whether a run begins with segment i. `run_item` is the first item of the current run.
  [[nodiscard]] bool begins_run(std::size_t i, std::optional<Word> run_item) const noexcept;

  /// The index after the last segment of the run that begins with segment i and `run_item`.
  [[nodiscard]] std::size_t end_of_run(std::size_t i, std::optional<Word> run_item) const noexcept;

  /// Whether the replacement that brought the waypoints of this run cut the curve where segment i
  /// begins. False if these waypoints came later, during or after a stop.
  [[nodiscard]] bool begins_at_cut(std::size_t i) const noexcept;

  /// Whether that replacement may have cut the curve there, later than at its own time.
  [[nodiscard]] bool may_begin_at_late_cut(std::size_t i) const noexcept;

  /// Whether segment i, the first one of the record, begins at another state than the stream's
  /// first waypoint: at a given start state, or at a replacement before the curve had begun to
  /// move.
  [[nodiscard]] bool begins_elsewhere(std::size_t i) const noexcept;

  /// Whether the run that begins with `run_item` is the last one of a finished stream.
  [[nodiscard]] bool is_last_run(std::optional<Word> run_item) const noexcept;

 private:
  [[nodiscard]] const SegmentCopy& before(std::size_t i) const noexcept { return segments_[i - 1]; }
  [[nodiscard]] std::optional<Time> replaced_from(std::size_t i) const noexcept;

  const StreamRecord& record_;
  std::span<const SegmentCopy> segments_;
  Replacements replacements_;
};

/// Follows the runs of a stream by its settled segments, to find those with which a part of a
/// record can begin without a restart: see StreamRecord. One thread uses it.
class RunStarts {
 public:
  /// Takes the next segment. `before`: the segment before it; null if that is unknown, and for
  /// segment 1. Returns whether a part can begin with the two.
  bool take(const SegmentCopy* before, const SegmentCopy& segment) noexcept;

  /// The next segment continues the run with this first item.
  void continue_run(Word run_item) noexcept;

 private:
  bool has_waypoints_ = false;      ///< whether the current run is known to have waypoints
  std::optional<Word> run_item_{};  ///< its first item, if it began with an entry
};

}  // namespace splinecast::ipc
