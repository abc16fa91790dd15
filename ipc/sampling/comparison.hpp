#pragma once

#include <cstdint>
#include <span>

#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/layout/summary.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Maximum number of segments that are compared.
inline constexpr int kMostCompared = 16;

/// The part of a curve that a reader has seen.
struct SeenCurve {
  const Summary& summary;   ///< of the revision that it saw
  const BoardSegment* own;  ///< a copy that is known to be part of that revision; null: none
  Time sampled_until;       ///< the latest time that it sampled
};

/// The result of a comparison with the curve seen before.
enum class Compared : std::uint8_t { same, changed, torn };

/// Compares the curve of a summary with the one seen, from the settled_until of the revision seen
/// to the latest time sampled. Compares the tags of the segments, or the bits of the reader's own
/// copy. A hold in the same position that now follows the end of the curve seen is equal.
/// Also returns `changed` if a segment cannot be compared, or if there are more than kMostCompared;
/// `torn` if the writer overtook it. `copy`, and `rest` with one value per dimension, are scratch.
/// O(D) per segment, wait-free.
[[nodiscard]] Compared compare_curve(const KnotBoardReader& board, const Summary& summary,
                                     const SeenCurve& seen, BoardSegment& copy,
                                     std::span<double> rest) noexcept;

}  // namespace splinecast::ipc
