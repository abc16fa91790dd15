#pragma once

#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

/// Finds the segment of a board that contains a time, under one summary: wait-free; stores nothing.
namespace splinecast::ipc {

/// The segment of t if it is the copied one or, judged by the length of that one, the next; else 0.
[[nodiscard]] Word number_near(const BoardSegment& copy, Time t) noexcept;

/// The last knot whose time is at or before t and at which a segment begins, by the packed times; 0
/// if t is before all. Exponential search from a guess that assumes even spacing, then bisection:
/// one or two loads for even spacing, at most 2 log n.
[[nodiscard]] Word number_by_hint(const KnotBoardReader& board, const Summary& summary,
                                  Time t) noexcept;

/// The same by the knots, under the summary's revision: copies log n of them. Returns false if one
/// was written meanwhile.
[[nodiscard]] bool number_by_cells(const KnotBoardReader& board, const Summary& summary, Time t,
                                   Word& number) noexcept;

}  // namespace splinecast::ipc
