#include "splinecast/core/splice.hpp"

#include <algorithm>
#include <array>

#include "splinecast/core/knot_ring.hpp"
#include "splinecast/core/slope_rule.hpp"
#include "splinecast/core/state.hpp"

namespace splinecast::core {
namespace {

/// A parabola's velocity and acceleration at one of its points, in one dimension.
struct Parabola {
  double velocity;
  double acceleration;
};

/// The parabola through three points at an end of them; `at` looks inwards.
Parabola at_end(const EndStencil& at, double inwards) noexcept {
  return {.velocity = parabola_end_slope(at),
          .acceleration = inwards * 2 * (at.m1 - at.m0) / (at.h0 + at.h1)};
}

Parabola at_middle(double h_before, double m_before, double h_after, double m_after) noexcept {
  const double h = h_before + h_after;
  return {.velocity = (h_after * m_before + h_before * m_after) / h,
          .acceleration = 2 * (m_after - m_before) / h};
}

Parabola at_run_start(const RunStart& at, std::size_t d) noexcept {
  const auto m = [d](const ChordInterval& interval) { return interval.chord[d]; };
  if (at.after2.h > 0) return at_end({at.after.h, m(at.after), at.after2.h, m(at.after2)}, 1);
  if (at.after.h > 0 && at.before.h > 0) {
    return at_middle(at.before.h, m(at.before), at.after.h, m(at.after));
  }
  if (at.after.h > 0) return {.velocity = m(at.after), .acceleration = 0};
  if (at.before2.h > 0) {
    return at_end({at.before.h, m(at.before), at.before2.h, m(at.before2)}, -1);
  }
  if (at.before.h > 0) return {.velocity = m(at.before), .acceleration = 0};
  return {.velocity = 0, .acceleration = 0};
}

}  // namespace

void build_splice(const Instant& from, const Instant& to, Segment& out) noexcept {
  const std::size_t dimensions = from.position.size();
  const double h = to_seconds(to.time - from.time);
  std::array<double, kMaxDimensions> chord{};
  write_chord(from.position, to.position, h, std::span(chord).first(dimensions));
  build_segment({.left = from.time,
                 .right = to.time,
                 .h = h,
                 .x0 = from.position,
                 .chord = std::span(chord).first(dimensions),
                 .v0 = from.velocity,
                 .v1 = to.velocity,
                 .a0 = from.acceleration,
                 .a1 = to.acceleration},
                out);
  out.kind = SegmentKind::splice;
}

void write_run_start(const RunStart& at, std::span<double> velocity,
                     std::span<double> acceleration) noexcept {
  for (std::size_t d = 0; d < velocity.size(); ++d) {
    const Parabola found = at_run_start(at, d);
    velocity[d] = found.velocity;
    acceleration[d] = found.acceleration;
  }
}

}  // namespace splinecast::core
