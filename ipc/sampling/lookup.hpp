#pragma once

#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

/// Which segment of a board a time lies on, under one head: wait-free; stores nothing.
namespace splinecast::ipc {

/// The segment of t if it is the copied one or, by its length, the next; else 0.
[[nodiscard]] Word number_near(const BoardSegment& copy, Time t) noexcept;

/// The last knot at or before whose time a segment begins, by the packed times; 0 if t is before
/// all. Exponential search from a guess by an even pace, then bisection: one or two loads where the
/// pace is even, at most 2 log n.
[[nodiscard]] Word number_by_hint(const KnotBoardReader& board, const Head& head, Time t) noexcept;

/// The same by the knots, under the revision of the head: log n of them. Returns false if one was
/// written meanwhile.
[[nodiscard]] bool number_by_cells(const KnotBoardReader& board, const Head& head, Time t,
                                   Word& number) noexcept;

}  // namespace splinecast::ipc
