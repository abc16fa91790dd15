#pragma once

#include <cstdint>
#include <string>

#include "ipc/board/reader.hpp"
#include "ipc/layout/header.hpp"
#include "splinecast/options.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The longest time that a new stream waits for the motion of an earlier one of its name to end.
inline constexpr Time kLongestOldMotion{3'600'000'000'000};

/// When the curve that a live board has published comes to rest, on CLOCK_MONOTONIC; min() if
/// nobody follows it: it is recorded, of another time namespace, retired, or has no curve.
[[nodiscard]] Time end_of_motion(const RegionHeader& header, const KnotBoardReader& board) noexcept;

/// Throws BadRegion if a motion ends more than kLongestOldMotion after now: no board may keep its
/// name for that long.
void require_near_end(const std::string& stream, Time end, Time now);

/// end_of_motion() of the board under the stream's name if it is another stream's than the one with
/// this id; min() if it is not, or if there is none that can be used. System calls.
[[nodiscard]] Time end_of_old_motion(const std::string& stream, std::uint64_t stream_id,
                                     const Trust& trust);

}  // namespace splinecast::ipc
