#include "core/forms/chord.hpp"

#include "core/polynomial/cubic.hpp"
#include "core/simd/clones.hpp"
#include "core/simd/lanes.hpp"

namespace splinecast::core {

SPLINECAST_VECTOR_CLONES
void write_chord(std::span<const double> from, std::span<const double> to, double h,
                 std::span<double> slope) noexcept {
  for_lanes(slope.size(), [&](auto lane, std::size_t first) {
    using Lane = typename decltype(lane)::type;
    const auto x0 = load_lane<Lane>(from.data() + first);
    const auto x1 = load_lane<Lane>(to.data() + first);
    store_lane<Lane>(slope.data() + first, chord_slope(x0, x1, h));
  });
}

}  // namespace splinecast::core
