#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "ipc/board/segment.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/verification/stream_record.hpp"

namespace splinecast::ipc {

/// The solver's decisions, derived from the segments of a record: which are entries, where a run
/// begins and ends. Segments are counted from 0. Changes nothing; safe from any thread.
class RecordedDecisions {
 public:
  /// The record outlives this.
  explicit RecordedDecisions(const StreamRecord& record) noexcept
      : record_(record), segments_(record.segments) {}

  /// Whether segment i is an entry onto a target.
  [[nodiscard]] bool is_entry(std::size_t i) const noexcept;

  /// Whether segment i follows an entry beyond the newest waypoint: the line, or the stop.
  [[nodiscard]] bool is_behind_entry(std::size_t i) const noexcept;

  /// Whether segment i is the entry by which a curve ends at its last waypoint.
  [[nodiscard]] bool is_ending(std::size_t i) const noexcept;

  /// Whether a run begins with segment i, if the current one has begun with `run_item`.
  [[nodiscard]] bool begins_run(std::size_t i, std::optional<Word> run_item) const noexcept;

  /// The segment after those of the run that begins with segment i and `run_item`.
  [[nodiscard]] std::size_t end_of_run(std::size_t i, std::optional<Word> run_item) const noexcept;

  /// Whether the curve was cut where segment i begins, for the waypoints that follow; false: they
  /// came later, after a stop.
  [[nodiscard]] bool begins_at_cut(std::size_t i) const noexcept;

  /// Whether the first run of the record does not begin with the stream's first waypoint: a state
  /// was given, or the curve was replaced before it had begun to move.
  [[nodiscard]] bool begins_elsewhere(std::size_t i) const noexcept;

  /// Whether the run that begins with `run_item` is the last one of a finished stream.
  [[nodiscard]] bool is_last_run(std::optional<Word> run_item) const noexcept;

 private:
  [[nodiscard]] const SegmentCopy& before(std::size_t i) const noexcept { return segments_[i - 1]; }

  const StreamRecord& record_;
  std::span<const SegmentCopy> segments_;
};

}  // namespace splinecast::ipc
