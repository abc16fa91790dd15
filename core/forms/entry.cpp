#include "core/forms/entry.hpp"

#include <algorithm>
#include <array>

#include "core/forms/chord.hpp"
#include "splinecast/state.hpp"

namespace splinecast::core {
void build_entry(const Instant& from, const Instant& to, Segment& out) noexcept {
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
  out.kind = SegmentKind::entry;
}

}  // namespace splinecast::core
