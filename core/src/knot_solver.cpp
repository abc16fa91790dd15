#include "splinecast/core/knot_solver.hpp"

#include <algorithm>

#include "back_substitution.hpp"
#include "dimension_lanes.hpp"
#include "knot_solvers.hpp"
#include "vector_clones.hpp"

namespace splinecast::core {

std::unique_ptr<KnotSolver> make_knot_solver(const Interpolant& how, const Condition& start,
                                             std::size_t dimensions, Use use) {
  switch (how.method->family) {
    case Family::local:
      return make_local_solver(how, start, dimensions);
    case Family::given:
      return make_given_solver(how, start, dimensions);
    case Family::smoothing:
      return make_smoothing_solver(how, start, dimensions, use);
    case Family::tridiagonal:
    case Family::unit:
      break;
  }
  return make_tridiagonal_solver(start, dimensions);
}

void solve_lone_knot(KnotRing& knots, const Condition& start) noexcept {
  const auto v = knots.values(0, KnotRing::kVelocity);
  if (start.kind == ConditionKind::velocity) {
    std::ranges::copy(start.value, v.begin());
  } else {
    std::ranges::fill(v, 0.0);
  }
}

SPLINECAST_VECTOR_CLONES
void back_substitute_to(KnotRing& knots, std::size_t last) noexcept {
  const std::size_t stride = knots.stride();
  for (std::size_t after = knots.newest(); after > last;) {
    const std::size_t count = std::min(after - last, knots.contiguous(after - 1));
    const KnotRing::Row* const row = &knots.row(after - 1);
    const double* const g = knots.values(after - 1, KnotRing::kG).data();
    double* const velocity = knots.values(after - 1, KnotRing::kVelocity).data();
    const double* const v_after = knots.values(after, KnotRing::kVelocity).data();
    // Dimensions outside, so that the velocity of the row before stays in a register.
    for_lanes(knots.dimensions(), [&](auto lane, std::size_t first) {
      using Lane = typename decltype(lane)::type;
      auto v = load_lane<Lane>(v_after + first);
      for (std::size_t k = 0; k < count; ++k) {
        const double gamma = (row - k)->prefix.gamma;
        v = back_substituted(gamma, load_lane<Lane>(g - k * stride + first), v);
        store_lane<Lane>(velocity - k * stride + first, v);
      }
    });
    after -= count;
  }
}

void close(KnotRing& knots, const Condition& end) noexcept {
  const std::size_t n = knots.newest();
  if (end.kind == ConditionKind::halt) knots.halt_at_end();
  solve_last(end, knots.end_intervals(), knots.row(n - 1).prefix.gamma,
             knots.values(n - 1, KnotRing::kG), knots.values(n, KnotRing::kVelocity));
}

void close(KnotRing& knots, Tail tail) noexcept {
  const std::size_t n = knots.newest();
  solve_tail(tail, knots.end_intervals(), knots.row(n - 1).prefix.gamma,
             knots.values(n - 1, KnotRing::kG), knots.values(n, KnotRing::kVelocity));
}

}  // namespace splinecast::core
