#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/summary.hpp"
#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Maximum time that a new stream waits for the motion of an earlier one of its name to end.
inline constexpr Time kLongestOldMotion{3'600'000'000'000};

/// Copies the last segment of a board's newest revision to `last`. Returns the summary of that
/// revision; without a curve its `newest` is 0, and nothing is copied. Nothing if a writer
/// overtakes each of a few tries.
[[nodiscard]] std::optional<Summary> take_last_segment(const KnotBoardReader& board,
                                                       BoardSegment& last) noexcept;

/// The time on CLOCK_MONOTONIC at which the published curve of a live board comes to rest; min() if
/// no reader follows the curve: it is recorded, of another time namespace, retired, or there is
/// none. If the stream follows a time law, the earliest time at which that can be: ask again then.
/// If its law has been removed, min().
[[nodiscard]] Time end_of_motion(const RegionHeader& header, const KnotBoardReader& board,
                                 const Trust& trust) noexcept;

/// The same for the board under a stream's name; min() if there is no usable board. System calls.
[[nodiscard]] Time end_of_motion(const std::string& stream, const Trust& trust);

/// Throws BadRegion if a motion ends more than kLongestOldMotion after now: a new stream does not
/// wait longer for its name.
void require_near_end(const std::string& stream, Time end, Time now);

/// end_of_motion() of the board under the stream's name if it belongs to a stream with another id;
/// min() if it does not, or if there is no usable board. System calls.
[[nodiscard]] Time end_of_old_motion(const std::string& stream, std::uint64_t stream_id,
                                     const Trust& trust);

}  // namespace splinecast::ipc
