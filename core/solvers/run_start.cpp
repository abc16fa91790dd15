#include "core/solvers/run_start.hpp"

#include "core/slopes/rule.hpp"

namespace splinecast::core {

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
