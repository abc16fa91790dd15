#include "splinecast/core/knot_solver.hpp"

#include <algorithm>

#include "back_substitution.hpp"
#include "knot_solvers.hpp"

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

void back_substitute_to(KnotRing& knots, std::size_t last) noexcept {
  const double* v_after = knots.values(knots.newest(), KnotRing::kVelocity).data();
  for (std::size_t i = knots.newest(); i-- > last;) {
    double* const v = knots.values(i, KnotRing::kVelocity).data();
    back_substitute_row(knots.row(i).prefix.gamma, knots.values(i, KnotRing::kG).data(), v_after, v,
                        knots.dimensions());
    v_after = v;
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
