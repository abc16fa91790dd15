#include "ipc/sampling/comparison.hpp"

#include <algorithm>
#include <cstddef>

#include "core/polynomial/segment.hpp"
#include "ipc/sampling/lookup.hpp"
#include "ipc/sampling/seconds.hpp"

namespace splinecast::ipc {
namespace {

/// Whether the reader has sampled only the hold before the first segment, and both curves hold the
/// same position there.
bool is_ahead(const BoardSegment& first, const SeenCurve& seen, std::size_t dimensions) noexcept {
  const bool is_known = seen.own != nullptr && seen.own->number() == 1;
  if (!is_known || first.number() != 1) return false;
  const auto position = seen.own->coefficients().first(dimensions);
  return seen.sampled_until < std::min(first.left(), seen.own->left()) &&
         std::ranges::equal(position, first.coefficients().first(position.size()));
}

/// Whether the sampled part of a segment is the same as in the curve that the reader saw.
bool is_unchanged(const BoardSegment& segment, const SeenCurve& seen,
                  std::size_t dimensions) noexcept {
  if (segment.changed_by(seen.own) <= seen.summary.revision) return true;
  if (seen.own == nullptr || seen.own->number() != segment.number()) return false;
  const BoardSegment& own = *seen.own;
  const bool ends_alike =
      segment.right() == own.right() || seen.sampled_until < std::min(segment.right(), own.right());
  const std::size_t values = static_cast<std::size_t>(own.order()) * dimensions;
  return ends_alike && segment.left() == own.left() && segment.order() == own.order() &&
         segment.kind() == own.kind() &&
         std::ranges::equal(segment.coefficients().first(values), own.coefficients().first(values));
}

/// Compares the curve after `last`, the newest segment of the curve that the reader saw: `same` if
/// a hold in the same position follows, until after the latest time sampled. Overwrites `last` with
/// the segment after it.
Compared compare_rest(const KnotBoardReader& board, const Summary& summary, Time sampled_until,
                      BoardSegment& last, std::span<double> rest) noexcept {
  const Time right = last.right();
  core::evaluate_derivative(last.order(), last.coefficients(), seconds_after(last.left(), right), 0,
                            rest);
  BoardSegment& next = last;
  const BoardSegment::Taken taken = next.take(board, summary, last.next());
  if (taken == BoardSegment::Taken::torn) return Compared::torn;
  const bool rests = taken == BoardSegment::Taken::whole && next.kind() == SegmentKind::hold &&
                     next.left() == right && sampled_until < next.right() &&
                     std::ranges::equal(next.coefficients().first(rest.size()), rest);
  return rests ? Compared::same : Compared::changed;
}

}  // namespace

Compared compare_curve(const KnotBoardReader& board, const Summary& summary, const SeenCurve& seen,
                       BoardSegment& copy, std::span<double> rest) noexcept {
  Word number = 0;
  if (summary.newest == 0) return Compared::changed;
  if (!number_by_cells(board, summary, seen.summary.settled_until, number)) return Compared::torn;
  if (number == 0 && summary.first == 1) number = 1;  // a hold may precede the first segment
  number = std::min(number, seen.summary.newest);
  if (number < summary.first) return Compared::changed;
  for (int compared = 0; compared < kMostCompared; ++compared) {
    const BoardSegment::Taken taken = copy.take(board, summary, number);
    if (taken == BoardSegment::Taken::torn) return Compared::torn;
    if (taken == BoardSegment::Taken::none) return Compared::changed;
    if (is_ahead(copy, seen, board.dimensions())) return Compared::same;
    if (!is_unchanged(copy, seen, board.dimensions())) return Compared::changed;
    if (seen.sampled_until < copy.right()) return Compared::same;
    const bool is_last = copy.is_last(summary);
    if (number == seen.summary.newest) {
      return is_last ? Compared::same
                     : compare_rest(board, summary, seen.sampled_until, copy, rest);
    }
    if (is_last) return Compared::changed;  // the curve now ends before the segments seen
    number = copy.next();
  }
  return Compared::changed;
}

}  // namespace splinecast::ipc
