#pragma once

#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

/// Finds the segment of a board that contains a time, under one summary: wait-free; stores nothing.
namespace splinecast::ipc {

/// A guess of the segment that contains t: the copied one; the next one if t is less than one
/// length of the copied segment after its end; else 0.
[[nodiscard]] Word number_near(const BoardSegment& copy, Time t) noexcept;

/// The number of the last segment that begins at or before t, by the packed times; 0 if all begin
/// after t. A hint: a writer may change the times meanwhile. Exponential search from a guess that
/// assumes even spacing, then bisection: one or two loads for even spacing, at most 2 log n.
[[nodiscard]] Word number_by_hint(const KnotBoardReader& board, const Summary& summary,
                                  Time t) noexcept;

/// Sets `number` to the same, exactly, by the knots of the summary's revision: copies the times of
/// log n knots. Returns false if one of them was written meanwhile.
[[nodiscard]] bool number_by_cells(const KnotBoardReader& board, const Summary& summary, Time t,
                                   Word& number) noexcept;

}  // namespace splinecast::ipc
