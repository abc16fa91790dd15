#include <utility>

#include "knot_solvers.hpp"

namespace splinecast::core {
namespace {

void eliminate_start(KnotRing& knots, const Condition& start) noexcept {
  knots.row(0).prefix.gamma =
      eliminate_first(start, knots.start_intervals(), knots.values(0, KnotRing::kG));
}

void eliminate(KnotRing& knots, std::size_t i) noexcept {
  knots.row(i).prefix.gamma =
      eliminate_interior(knots.neighbours(i), knots.row(i - 1).prefix.gamma,
                         knots.values(i - 1, KnotRing::kG), knots.values(i, KnotRing::kG));
}

/// `c2`.
class TridiagonalSolver final : public KnotSolver {
 public:
  TridiagonalSolver(const Condition& start, std::size_t dimensions)
      : KnotSolver(start, dimensions) {}

  void push(KnotRing& knots, const Waypoint& waypoint) const noexcept override {
    knots.push(waypoint.time, waypoint.position);
    const std::size_t n = knots.newest();
    if (n == 0) {
      solve_lone_knot(knots, start());
      return;
    }
    // Not-a-knot looks at two intervals, so that row 0 must wait for the second one.
    const std::size_t start_known_at = start().kind == ConditionKind::not_a_knot ? 2 : 1;
    if (n == start_known_at) eliminate_start(knots, start());
    if (n > 1) eliminate(knots, n - 1);
  }

  void solve(KnotRing& knots, Tail tail, std::size_t last) const noexcept override {
    if (knots.newest() == 0) return;
    close(knots, tail);
    back_substitute_to(knots, last);
  }

  void solve(KnotRing& knots, const Condition& end, std::size_t last) const noexcept override {
    if (knots.newest() == 0) return;
    close(knots, end);
    back_substitute_to(knots, last);
  }

  void eliminate_again(KnotRing& knots) const noexcept override {
    if (knots.size() > 1) eliminate_start(knots, start());
    for (std::size_t i = 1; i < knots.newest(); ++i) eliminate(knots, i);
  }
};

}  // namespace

std::unique_ptr<KnotSolver> make_tridiagonal_solver(const Condition& start,
                                                    std::size_t dimensions) {
  return std::make_unique<TridiagonalSolver>(start, dimensions);
}

}  // namespace splinecast::core
