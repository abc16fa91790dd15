#include "core/solvers/knot_solver.hpp"

#include <algorithm>
#include <array>

#include "core/simd/clones.hpp"
#include "core/simd/lanes.hpp"
#include "core/solvers/back_substitution.hpp"
#include "core/solvers/families.hpp"

namespace splinecast::core {

std::unique_ptr<KnotSolver> make_knot_solver(const Interpolant& how, const Condition& start,
                                             std::size_t dimensions, Use use) {
  return procedure_of(*how.method).solver(how, start, dimensions, use);
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
  const OlderRows rows(knots, last);
  const double* const newest = knots.values(knots.newest(), KnotRing::kVelocity).data();
  const auto body = [&](auto lane, auto groups, std::size_t first) __attribute__((always_inline)) {
    using Lane = typename decltype(lane)::type;
    std::array<Lane, decltype(groups)::value> v;  // NOLINT(*-member-init)
    for (std::size_t k = 0; k < v.size(); ++k) {
      v[k] = load_lane<Lane>(newest + first + k * kWidth<Lane>);
    }
    rows.solve<false>(first, v);
  };
  for_padded_lanes(knots.stride(), body);
}

void close(KnotRing& knots, const Condition& end) noexcept {
  const std::size_t n = knots.newest();
  if (end.kind == ConditionKind::halt) knots.halt_at_end();
  solve_last(end, knots.end_intervals(), knots.gamma(n - 1), knots.values(n - 1, KnotRing::kG),
             knots.values(n, KnotRing::kVelocity));
}

void close(KnotRing& knots, Tail tail) noexcept {
  const std::size_t n = knots.newest();
  solve_tail(tail, knots.end_intervals(), knots.gamma(n - 1), knots.values(n - 1, KnotRing::kG),
             knots.values(n, KnotRing::kVelocity));
}

}  // namespace splinecast::core
