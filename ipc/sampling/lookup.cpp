#include "ipc/sampling/lookup.hpp"

#include "core/forms/knot_segment.hpp"
#include "ipc/sampling/seconds.hpp"

namespace splinecast::ipc {
namespace {

/// The segment of the summary that contains t if the knots are evenly spaced.
Word guess_by_pace(const KnotBoardReader& board, const Summary& summary, Time t) noexcept {
  const Time oldest = board.time_hint(summary.first);
  const double share =
      seconds_after(oldest, t) / seconds_after(oldest, board.time_hint(summary.newest));
  const auto intervals = static_cast<double>(summary.newest - summary.first);
  // NaN or out of range: clamps to the first or last segment.
  if (!(share > 0)) return summary.first;
  return share < 1 ? summary.first + static_cast<Word>(share * intervals) : summary.newest;
}

/// Sets `begin` to the time at which the segment of knot `number` begins. If no segment begins
/// there, sets `is_end`, and `begin` to the beginning of the next segment or, at the last knot of a
/// finished curve, to the end of the curve. Returns false if a knot was written meanwhile.
bool begin_of(const KnotBoardReader& board, const Summary& summary, Word number, Time& begin,
              bool& is_end) noexcept {
  core::SegmentForm form{};
  if (!board.copy_time(number, summary.revision, begin, form)) return false;
  is_end = form == core::SegmentForm::none;
  if (!is_end || number == summary.newest) return true;
  return board.copy_time(number + 1, summary.revision, begin, form);
}

}  // namespace

Word number_near(const BoardSegment& copy, Time t) noexcept {
  if (!copy.is_there() || t < copy.left()) return 0;
  if (t < copy.right()) return copy.number();
  const Word length = to_word(copy.right()) - to_word(copy.left());
  return to_word(t) - to_word(copy.right()) < length ? copy.next() : 0;
}

Word number_by_hint(const KnotBoardReader& board, const Summary& summary, Time t) noexcept {
  Word low = summary.first;
  Word high = summary.newest + 1;
  const auto is_after = [&](Word number) { return board.time_hint(number) > t; };
  const Word guess = guess_by_pace(board, summary, t);
  if (is_after(guess)) {
    high = guess;
    for (Word step = 1; step <= high - low; step *= 2) {
      if (!is_after(high - step)) {
        low = high - step + 1;
        break;
      }
      high -= step;
    }
  } else {
    low = guess + 1;
    for (Word step = 1; step <= high - low; step *= 2) {
      if (is_after(low + step - 1)) {
        high = low + step - 1;
        break;
      }
      low += step;
    }
  }
  while (low < high) {
    const Word middle = low + (high - low) / 2;
    if (is_after(middle)) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low == summary.first ? 0 : low - 1;
}

bool number_by_cells(const KnotBoardReader& board, const Summary& summary, Time t,
                     Word& number) noexcept {
  Word low = summary.first;
  Word high = summary.newest + 1;
  bool is_end = false;
  while (low < high) {
    const Word middle = low + (high - low) / 2;
    Time begin{};
    if (!begin_of(board, summary, middle, begin, is_end)) return false;
    if (begin <= t) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  number = low == summary.first ? 0 : low - 1;
  if (number > summary.first && number == summary.newest) {
    Time begin{};
    if (!begin_of(board, summary, number, begin, is_end)) return false;
    if (is_end) --number;
  }
  return true;
}

}  // namespace splinecast::ipc
