#include "ipc/sampling/snapshot.hpp"

#include <algorithm>
#include <cstddef>

#include "ipc/sampling/lookup.hpp"
#include "ipc/sampling/sampler.hpp"

namespace splinecast::ipc {
namespace {

/// Subtracts values, element by element.
void subtract(std::span<double> from, std::span<const double> values) noexcept {
  for (std::size_t d = 0; d < from.size(); ++d) from[d] -= values[d];
}

/// Computes the acceleration step at the left end of a snapshot's oldest segment. On entry
/// `oldest.acceleration_step` is the acceleration after that knot. Returns false if the writer
/// overtook it.
bool finish_oldest_step(const SnapshotSource& source, SegmentCopy& oldest) {
  if (oldest.number == 1) {
    const bool is_held = source.is_live && oldest.has_waypoint;
    if (!is_held) std::ranges::fill(oldest.acceleration_step, 0.0);  // no segment before it
    return true;
  }
  const auto before = segment_before(source.board, source.summary, oldest.number);
  if (!before) return false;
  if (*before == 0) {
    oldest.acceleration_step.clear();
    return true;
  }
  BoardSegment& copy = source.copy;
  if (copy.take(source.board, source.summary, *before) != BoardSegment::Taken::whole) return false;
  copy.write_accelerations(source.start_acceleration, source.end_acceleration);
  subtract(oldest.acceleration_step, source.end_acceleration);
  return true;
}

}  // namespace

/// Copies the segments `oldest` to `newest` under the source's revision, with their acceleration
/// steps. Returns false if the writer overtook it.
bool BoardSnapshot::copy_segments(const SnapshotSource& source, Word oldest, Word newest) {
  const KnotBoardReader& board = source.board;
  BoardSegment& copy = source.copy;
  std::size_t count = 0;
  // Copies the newest segments first, because the writer changes them first.
  for (Word number = newest;;) {
    if (copy.take(board, source.summary, number) != BoardSegment::Taken::whole) return false;
    if (segments_.size() == count) segments_.emplace_back();
    SegmentCopy& segment = segments_[count];
    copy.copy_to(segment);
    segment.acceleration_step.resize(dimensions_);
    copy.write_accelerations(segment.acceleration_step, source.end_acceleration);
    if (count > 0) subtract(segments_[count - 1].acceleration_step, source.end_acceleration);
    ++count;
    if (number == oldest) break;
    const auto before = segment_before(board, source.summary, number);
    if (!before || *before < oldest) return false;
    number = *before;
  }
  if (!finish_oldest_step(source, segments_[count - 1])) return false;
  for (SegmentCopy& segment : std::span(segments_).first(count)) {
    if (segment.acceleration_step.empty()) continue;
    source.kinds.normalise_step(std::span(segment.coefficients).first(dimensions_),
                                segment.acceleration_step);
  }
  std::reverse(segments_.begin(), segments_.begin() + static_cast<std::ptrdiff_t>(count));
  size_ = count;
  return true;
}

SampleStatus Sampler::snapshot(Time from, Time to, BoardSnapshot& out) {
  out.size_ = 0;
  if (out.dimensions() != board_->dimensions()) return SampleStatus::wrong_dimension;
  const SnapshotSource source{.board = *board_,
                              .summary = summary_,
                              .kinds = kinds_,
                              .is_live = is_live(clock_),
                              .copy = kept_.spare(),
                              .start_acceleration = start_acceleration_,
                              .end_acceleration = end_acceleration_};
  for (int attempt = 0; attempt < kTries; ++attempt) {
    if (board_->retired()) return SampleStatus::retired;
    const Look look = board_->look();
    if (look.revision == 0) return SampleStatus::no_data;
    summary_.settled_until =
        look.revision == summary_.revision ? look.settled_until : summary_.settled_until;
    if ((look.revision != summary_.revision && !see(look)) ||
        !board_->copy_summary(look, out.summary_)) {
      continue;
    }
    if (summary_.newest == 0) return SampleStatus::no_data;
    Word oldest = 0;
    Word newest = 0;
    if (!number_by_cells(*board_, summary_, from, oldest)) continue;
    if (!number_by_cells(*board_, summary_, to, newest)) continue;
    if (oldest == 0) return SampleStatus::before_history;
    if (newest >= oldest && !out.copy_segments(source, oldest, newest)) continue;
    return out.has_settled(to) ? SampleStatus::settled : SampleStatus::provisional;
  }
  return SampleStatus::busy;
}

}  // namespace splinecast::ipc
