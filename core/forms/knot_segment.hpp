#pragma once

#include <cstdint>
#include <span>

#include "core/polynomial/segment.hpp"
#include "splinecast/time.hpp"

/// Segments made from the knots at their ends: the one way from knots to polynomials, for the
/// window that solves them and for whoever reads them, so that all have the same bits.
namespace splinecast::core {

/// How the segment that begins at a knot is made. It is all that must be known besides the knots.
enum class SegmentForm : std::uint8_t {
  none = 0,    ///< no segment begins here
  cubic,       ///< from position and velocity at both ends
  halt_left,   ///< order 6: acceleration 0 at the left end, that of the cubic at the right one
  halt_right,  ///< the other way round
  halt_both,   ///< order 6: acceleration 0 at both ends
  quintic,     ///< order 6, with the accelerations that its waypoints carry
  splice,      ///< order 6, from a given state to a knot
  stop,        ///< from position, velocity and acceleration of its left knot to rest
  hold,        ///< at rest
};
inline constexpr int kSegmentForms = 9;

/// Whether a segment of this form needs the acceleration of its left or right knot.
[[nodiscard]] constexpr bool starts_with_acceleration(SegmentForm form) noexcept {
  return form == SegmentForm::quintic || form == SegmentForm::splice || form == SegmentForm::stop;
}
[[nodiscard]] constexpr bool arrives_with_acceleration(SegmentForm form) noexcept {
  return form == SegmentForm::quintic || form == SegmentForm::splice;
}

/// A knot as the segments at it see it. Spans hold one value per dimension.
struct SegmentEnd {
  Time time{};
  std::span<const double> waypoint;      ///< position, before smoothing
  std::span<const double> velocity;      ///<
  std::span<const double> acceleration;  ///< empty where no segment needs it
  std::span<const double> residual;      ///< waypoint − position; empty unless the method smooths
};

/// Writes the segment of a form between two knots, right.time > left.time: of a stop it ends at
/// rest there, of a hold it lasts until then (its times may be equal), and neither looks at the
/// right knot otherwise. `form` is not `none`. Sets everything but `acceleration_step`. O(D).
void build_segment(SegmentForm form, const SegmentEnd& left, const SegmentEnd& right,
                   Segment& out) noexcept;

/// What a cubic is made of where the curve passes both knots: D values each, and right > left.
struct CubicEnds {
  Time left{};
  Time right{};
  const double* left_position;
  const double* right_position;
  const double* left_velocity;
  const double* right_velocity;
};

/// The same for the form `cubic` without residuals, which most segments are. Returns a sum of the
/// magnitudes of the coefficients, of which some may count twice: at least the largest of them, and
/// NaN if one of them is NaN. O(D).
double build_cubic(const CubicEnds& ends, Segment& out) noexcept;

/// Writes the accelerations with which such a segment starts and arrives, `start` and `end`; at
/// natural ends, that is where nothing cuts it. O(D).
void write_end_accelerations(SegmentForm form, const SegmentEnd& left, const SegmentEnd& right,
                             std::span<double> start, std::span<double> end) noexcept;

/// Where the curve passes a knot: its waypoint, or beside it. D values.
void write_position(const SegmentEnd& knot, std::span<double> position) noexcept;

}  // namespace splinecast::core
