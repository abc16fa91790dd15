#pragma once

#include <cstdint>
#include <span>

#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// How many segments are compared at most.
inline constexpr int kMostCompared = 16;

/// What a reader has seen of a curve.
struct SeenCurve {
  const Head& head;         ///< of the revision that it saw
  const BoardSegment* own;  ///< a copy that is known to be part of that revision; null: none
  Time sampled_until;       ///< the latest time that it sampled
};

/// What a comparison with the curve seen before has found.
enum class Compared : std::uint8_t { same, changed, torn };

/// Whether the curve under a head is the one that was seen, from what was settled then to the
/// latest time sampled: by the tags of its segments, or by the bits of the reader's own copy; a
/// rest may go on as a hold. What cannot be compared has changed, and so has what takes more than
/// kMostCompared segments. `copy` and `rest`, of a value per dimension, are scratch. O(D) per
/// segment, wait-free.
[[nodiscard]] Compared compare_curve(const KnotBoardReader& board, const Head& head,
                                     const SeenCurve& seen, BoardSegment& copy,
                                     std::span<double> rest) noexcept;

}  // namespace splinecast::ipc
