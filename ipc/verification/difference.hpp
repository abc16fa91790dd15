#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "core/polynomial/segment.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The first difference between a published stream and the same stream solved again.
struct Difference {
  Word segment = 0;
  Time left{};         ///< its left end, as published
  Time right{};        ///< its right end, as published
  std::string what{};  ///< such as `coefficient 3 of dimension 0`
  std::string published{};
  std::string solved{};
};

/// Whether values have the same bits: 0 and -0 do not.
[[nodiscard]] bool same_bits(double a, double b) noexcept;
[[nodiscard]] bool same_bits(std::span<const double> a, std::span<const double> b) noexcept;

/// A value as text: a number with as few digits as reproduce it exactly, a time such as `5 ns`, a
/// kind such as `hold`.
[[nodiscard]] std::string in_words(double value);
[[nodiscard]] std::string in_words(Time time);
[[nodiscard]] std::string in_words(SegmentKind kind);
/// The first value as text, such as `[1, …]`. There must be at least one.
[[nodiscard]] std::string first_in_words(std::span<const double> values);

/// Compares a published segment with the solved one, bit by bit. `may_be_cut`: the published one
/// may end earlier. Returns the first difference, with `segment`, `left` and `right` unset; nothing
/// if the segments are equal. O(D).
[[nodiscard]] std::optional<Difference> compare(const SegmentCopy& published,
                                                const core::Segment& solved, std::size_t dimensions,
                                                bool may_be_cut);

/// Compares the acceleration step of a segment with those of the segment before it and of its own
/// begin, up to rounding; nothing if the segments do not follow one another.
[[nodiscard]] std::optional<Difference> compare_step(const SegmentCopy& before,
                                                     const SegmentCopy& segment);

}  // namespace splinecast::ipc
