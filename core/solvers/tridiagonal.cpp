#include <algorithm>
#include <array>
#include <utility>

#include "core/simd/clones.hpp"
#include "core/simd/lanes.hpp"
#include "core/solvers/back_substitution.hpp"
#include "core/solvers/families.hpp"
#include "core/solvers/tridiagonal_formulas.hpp"

namespace splinecast::core {
namespace {

void eliminate_start(KnotRing& knots, const Condition& start) noexcept {
  knots.gamma(0) = eliminate_first(start, knots.start_intervals(), knots.values(0, KnotRing::kG));
}

void eliminate(KnotRing& knots, std::size_t i) noexcept {
  knots.gamma(i) =
      eliminate_interior(knots.neighbours(i), knots.gamma(i - 1), knots.values(i - 1, KnotRing::kG),
                         knots.values(i, KnotRing::kG));
}

/// Does `push` and `solve` in one pass, for the fourth knot or a later one: writes the waypoint of
/// the newest knot, which was pushed without it, eliminates the row before it and solves the knots
/// from `last` on. The values of a dimension stay in registers. Does not solve row 0: its γ depends
/// on the start condition and may be 0.
SPLINECAST_VECTOR_CLONES
void append_after(KnotRing& knots, std::span<const double> waypoint, Tail tail,
                  std::size_t last) noexcept {
  const std::size_t n = knots.newest();
  const double h = knots.row(n - 1).h;
  const double h_before = knots.row(n - 2).h;
  const InteriorRow row(h_before, h, knots.gamma(n - 2));
  const double gamma = row.gamma();
  knots.gamma(n - 1) = gamma;
  const TailRow end(tail, h, h_before, gamma);
  const OlderRows rows(knots, std::max<std::size_t>(last, 1));
  const double* const position = waypoint.data();
  const std::size_t dimensions = waypoint.size();
  const std::size_t at = knots.place_of(n);
  const std::size_t before = knots.place_of(n - 1);
  const std::size_t before2 = knots.place_of(n - 2);
  double* const x_all = knots.array(KnotRing::kWaypoint);
  double* const chord_all = knots.array(KnotRing::kChord);
  double* const g_all = knots.array(KnotRing::kG);
  double* const v_all = knots.array(KnotRing::kVelocity);
  const auto body = [&](auto lane, auto groups, std::size_t first) __attribute__((always_inline)) {
    using Lane = typename decltype(lane)::type;
    std::array<Lane, decltype(groups)::value> v;  // NOLINT(*-member-init)
    for (std::size_t k = 0; k < v.size(); ++k) {
      const std::size_t d = first + k * kWidth<Lane>;
      const auto x = load_first_of_lane<Lane>(position + d, dimensions - d);
      const Lane m = (x - load_lane<Lane>(x_all + before + d)) / h;
      const auto m_before = load_lane<Lane>(chord_all + before2 + d);
      const Lane g = row.g(m_before, m, load_lane<Lane>(g_all + before2 + d));
      v[k] = end.velocity(m, m_before, g);
      store_lane(x_all + at + d, x);
      store_lane(chord_all + before + d, m);
      store_lane(g_all + before + d, g);
      store_lane(v_all + at + d, v[k]);
    }
    rows.solve<true>(first, v);
  };
  for_padded_lanes(knots.stride(), body);
}

/// The solver of `c2`.
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
    // Not-a-knot needs two intervals, so that row 0 must wait for the second one.
    const std::size_t start_known_at = start().kind == ConditionKind::not_a_knot ? 2 : 1;
    if (n == start_known_at) eliminate_start(knots, start());
    if (n > 1) eliminate(knots, n - 1);
  }

  void solve(KnotRing& knots, Tail tail, std::size_t first) const noexcept override {
    if (knots.newest() == 0) return;
    close(knots, tail);
    back_substitute_to(knots, first);
  }

  void solve(KnotRing& knots, const Condition& end, std::size_t first) const noexcept override {
    if (knots.newest() == 0) return;
    close(knots, end);
    back_substitute_to(knots, first);
  }

  void append(KnotRing& knots, const Waypoint& waypoint, Tail tail,
              std::size_t first) const noexcept override {
    // The first rows depend on the start condition and have fewer rows before them.
    if (knots.size() < 3) return KnotSolver::append(knots, waypoint, tail, first);
    knots.push(waypoint.time);
    append_after(knots, waypoint.position, tail, first);
    if (first > 0) return;
    back_substitute(knots.gamma(0), knots.values(0, KnotRing::kG),
                    knots.values(1, KnotRing::kVelocity), knots.values(0, KnotRing::kVelocity));
  }

  void eliminate_again(KnotRing& knots) const noexcept override {
    if (knots.size() > 1) eliminate_start(knots, start());
    for (std::size_t i = 1; i < knots.newest(); ++i) eliminate(knots, i);
  }
};

}  // namespace

std::unique_ptr<KnotSolver> make_tridiagonal_solver(const Interpolant& /*how*/,
                                                    const Condition& start, std::size_t dimensions,
                                                    Use /*use*/) {
  return std::make_unique<TridiagonalSolver>(start, dimensions);
}

}  // namespace splinecast::core
