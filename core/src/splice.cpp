#include "splinecast/core/splice.hpp"

#include <algorithm>
#include <array>

#include "splinecast/core/knot_ring.hpp"
#include "splinecast/core/slope_rule.hpp"
#include "splinecast/core/state.hpp"

namespace splinecast::core {
namespace {

/// The slope of the parabola through a point and its neighbours on both sides.
double slope_at_middle(double h_before, double m_before, double h_after, double m_after) noexcept {
  return (h_after * m_before + h_before * m_after) / (h_before + h_after);
}

double slope_at_run_start(const RunStart& at, std::size_t d) noexcept {
  const auto m = [d](const ChordInterval& interval) { return interval.chord[d]; };
  if (at.after2.h > 0) {
    return parabola_end_slope({at.after.h, m(at.after), at.after2.h, m(at.after2)});
  }
  if (at.after.h > 0 && at.before.h > 0) {
    return slope_at_middle(at.before.h, m(at.before), at.after.h, m(at.after));
  }
  if (at.after.h > 0) return m(at.after);
  if (at.before2.h > 0) {
    return parabola_end_slope({at.before.h, m(at.before), at.before2.h, m(at.before2)});
  }
  return at.before.h > 0 ? m(at.before) : 0;
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

void write_run_start(const RunStart& at, std::span<double> velocity) noexcept {
  for (std::size_t d = 0; d < velocity.size(); ++d) velocity[d] = slope_at_run_start(at, d);
}

}  // namespace splinecast::core
