#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/polynomial/segment.hpp"
#include "splinecast/state.hpp"

/// Least and greatest values of a segment and its derivatives.
///
/// They lie at the ends of the range or at a zero of the next derivative: in closed form for a
/// linear and a quadratic derivative; for higher ones the zeros of the derivative after it cut the
/// range into monotone pieces, each with one zero at most, which Halley's steps find inside a
/// bracket. Every value is that of `evaluate` at its u, to the bit, and exact to kExtremeRounding
/// times `size_of_terms`. Bounded work, no allocation, no exception; safe from any thread. A value
/// that is no number makes both extremes none.
namespace splinecast::core {

/// A value, and where it is: u seconds after the left knot.
struct Extreme {
  double value = 0;
  double u = 0;
};

struct SegmentRange {
  Extreme least{};
  Extreme greatest{};

  /// The one with the larger absolute value; NaN if either is.
  [[nodiscard]] Extreme largest() const noexcept {
    return -least.value > greatest.value ? least : greatest;
  }
};

/// Error of an extreme, relative to `size_of_terms`: at most 8 units in the last place.
inline constexpr double kExtremeRounding = 0x1p-50;

/// A part of one polynomial with D dimensions: `coefficients` holds order·D values, [power]
/// [dimension], 1 ≤ order ≤ kMaxOrder; from ≤ to are seconds after the left knot. A view.
struct SegmentPart {
  int order = kCubicOrder;
  std::span<const double> coefficients;
  std::size_t dimensions = 0;
  double from = 0;
  double to = 0;
};

/// The whole of a segment.
[[nodiscard]] SegmentPart part_of(const Segment& segment) noexcept;

/// The range of a derivative, 0 (the position) to 3, of dimension d.
[[nodiscard]] SegmentRange range_of(int order, std::span<const double> coefficients,
                                    std::size_t dimensions, std::size_t d, int derivative,
                                    double from, double to) noexcept;

/// The ranges of the derivatives asked for, in the places of their numbers; the others are left
/// alone. Takes less time than `range_of` for each of them.
void write_ranges(const SegmentPart& part, std::size_t d, Derivatives which,
                  std::array<SegmentRange, 4>& out) noexcept;

/// Σ |c_k k!/(k−m)! u^(k−m)| for the m-th derivative of dimension d, at the end of the part that
/// is farther from the left knot: what rounding is relative to.
[[nodiscard]] double size_of_terms(const SegmentPart& part, std::size_t d, int derivative) noexcept;

}  // namespace splinecast::core
