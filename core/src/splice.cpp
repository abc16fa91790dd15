#include "splinecast/core/splice.hpp"

#include <algorithm>
#include <array>

#include "splinecast/core/knot_ring.hpp"
#include "splinecast/core/slope_rule.hpp"
#include "splinecast/core/state.hpp"

namespace splinecast::core {
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

void write_run_start(const KnotRing& knots, std::span<double> velocity) noexcept {
  const auto h = [&](std::size_t i) { return knots.row(i).h; };
  const auto chord = [&](std::size_t i) { return knots.values(i, KnotRing::kChord); };
  for (std::size_t d = 0; d < velocity.size(); ++d) {
    velocity[d] = knots.size() > 2   ? parabola_end_slope({h(0), chord(0)[d], h(1), chord(1)[d]})
                  : knots.size() > 1 ? chord(0)[d]
                                     : 0;
  }
}

}  // namespace splinecast::core
