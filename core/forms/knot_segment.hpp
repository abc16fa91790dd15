#pragma once

#include <cstdint>
#include <span>

#include "core/polynomial/segment.hpp"
#include "splinecast/time.hpp"

/// Builds segments from the data of the knots at their ends. Uses the same formulas as the window
/// that solves the knots, so that all processes get the same bits.
namespace splinecast::core {

/// How the segment that begins at a knot is built from its knots.
enum class SegmentForm : std::uint8_t {
  none = 0,    ///< no segment begins at this knot
  cubic,       ///< from position and velocity at both ends
  halt_left,   ///< order 6: acceleration 0 at the left end, that of the cubic at the right end
  halt_right,  ///< order 6: acceleration 0 at the right end, that of the cubic at the left end
  halt_both,   ///< order 6: acceleration 0 at both ends
  quintic,     ///< order 6, with the accelerations given with its waypoints
  entry,       ///< order 6, from a given state to a knot
  stop,        ///< stop segment: from position, velocity and acceleration of its left knot to rest
  hold,        ///< at rest
  slowed,      ///< order 6, between two states of a path that is slowed down: see Slowing
};
inline constexpr int kSegmentForms = 10;

/// Whether a segment of this form needs the acceleration of its left or right knot.
[[nodiscard]] constexpr bool starts_with_acceleration(SegmentForm form) noexcept {
  return form == SegmentForm::quintic || form == SegmentForm::entry || form == SegmentForm::stop ||
         form == SegmentForm::slowed;
}
[[nodiscard]] constexpr bool arrives_with_acceleration(SegmentForm form) noexcept {
  return form == SegmentForm::quintic || form == SegmentForm::entry || form == SegmentForm::slowed;
}

/// The data of a knot from which segments are built. Spans hold one value per dimension.
struct SegmentEnd {
  Time time{};
  std::span<const double> waypoint;  ///< position, before smoothing
  std::span<const double> velocity;
  std::span<const double> acceleration;  ///< empty where no segment needs it
  std::span<const double> residual;      ///< waypoint − position; empty unless the method smooths
};

/// Writes the segment of a form between two knots, right.time > left.time; for a hold, the times
/// may be equal. A stop or a hold uses only the time of the right knot, at which it ends. `form`
/// must not be `none`. Sets everything except `acceleration_step`. O(D).
void build_segment(SegmentForm form, const SegmentEnd& left, const SegmentEnd& right,
                   Segment& out) noexcept;

/// The data of a cubic whose curve passes through both waypoints: D values each, and right > left.
struct CubicEnds {
  Time left{};
  Time right{};
  const double* left_position;
  const double* right_position;
  const double* left_velocity;
  const double* right_velocity;
};

/// Writes a segment of the form `cubic` without residuals, the most common case. Returns a sum of
/// the magnitudes of its coefficients, in which some may count twice: at least the largest
/// magnitude, and NaN if a coefficient is NaN. O(D).
double build_cubic(const CubicEnds& ends, Segment& out) noexcept;

/// Writes the accelerations at the start and the end of the segment that `build_segment` writes for
/// the same arguments. O(D).
void write_end_accelerations(SegmentForm form, const SegmentEnd& left, const SegmentEnd& right,
                             std::span<double> start, std::span<double> end) noexcept;

/// Writes the position of the curve at a knot: the waypoint, or the smoothed position. D values.
void write_position(const SegmentEnd& knot, std::span<double> position) noexcept;

}  // namespace splinecast::core
