#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/polynomial/segment.hpp"
#include "splinecast/state.hpp"

/// Minimum and maximum of a segment and of its derivatives.
///
/// An extreme is at an end of the range or at a zero of the next derivative. Zeros of a linear or
/// quadratic derivative have a closed form. For a higher degree, the zeros of the derivative after
/// it divide the range into monotone pieces with at most one zero each, found by Halley's steps
/// inside a bracket. Every value has the bits of `evaluate` at its u, and is exact to
/// kExtremeRounding times `size_of_terms`. Bounded work, no allocation, no exception; safe from any
/// thread. If a value is NaN, both extremes are NaN.
namespace splinecast::core {

/// A value and its place: u seconds after the left knot.
struct Extreme {
  double value = 0;
  double u = 0;
};

struct SegmentRange {
  Extreme least{};
  Extreme greatest{};

  /// The extreme with the larger absolute value; NaN if either is NaN.
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

/// Writes the ranges of the derivatives in `which`, indexed by derivative, and leaves the others
/// unchanged. Faster than one `range_of` for each.
void write_ranges(const SegmentPart& part, std::size_t d, Derivatives which,
                  std::array<SegmentRange, 4>& out) noexcept;

/// Σ |c_k k!/(k−m)! u^(k−m)| for the m-th derivative of dimension d, at the end of the part that is
/// farther from the left knot: the scale of rounding errors.
[[nodiscard]] double size_of_terms(const SegmentPart& part, std::size_t d, int derivative) noexcept;

}  // namespace splinecast::core
