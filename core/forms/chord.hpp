#pragma once

#include <span>

namespace splinecast::core {

/// Writes the chord slope from one position to another that is h seconds later: O(D).
void write_chord(std::span<const double> from, std::span<const double> to, double h,
                 std::span<double> slope) noexcept;

/// The chord slope of the smoothed curve between two knots, from the chord slope of their
/// waypoints. Does not use the smoothed positions: they have fewer exact digits if their offset is
/// large.
template <typename Real>
Real smoothed_chord(double chord, double h, Real residual, Real residual_after) noexcept {
  return Real(chord) - (residual_after - residual) / h;
}

}  // namespace splinecast::core
