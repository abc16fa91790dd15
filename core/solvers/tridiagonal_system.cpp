#include "core/solvers/tridiagonal_system.hpp"

#include <algorithm>
#include <cstddef>

#include "core/simd/clones.hpp"
#include "core/simd/lanes.hpp"
#include "core/solvers/back_substitution.hpp"
#include "core/solvers/tridiagonal_formulas.hpp"

namespace splinecast::core {
namespace {

/// The end that a row belongs to: the acceleration has the opposite sign at the other end.
enum class Side { start, end };

/// An end row before elimination: inner · v_neighbour + outer · v_end = slope · m + value[d] ·
/// scale.
struct EndRow {
  double inner;
  double outer;
  double slope;
  double scale;
  std::span<const double> value;

  [[nodiscard]] double right_side(double m, std::size_t d) const noexcept {
    return value.empty() ? slope * m : slope * m + scale * value[d];
  }
};

/// Continuity of the third derivative at the next knot, minus that knot's own row, so that two
/// unknowns remain.
EndRow not_a_knot_row(const EndIntervals& at) noexcept {
  const double both = at.h + at.h_next;
  return {.inner = both,
          .outer = at.h_next,
          .slope = (at.h + 2 * both) * at.h_next / both,
          .scale = at.h * at.h / both,
          .value = at.chord_next};
}

/// The row of an end condition (math 6a, 6b). Natural and `own` are the row of acceleration 0,
/// clamped and halt the row of velocity 0.
EndRow end_row(const Condition& condition, const EndIntervals& at, Side side) noexcept {
  const double half_h = side == Side::start ? -at.h / 2 : at.h / 2;
  switch (condition.kind) {
    case ConditionKind::natural:
    case ConditionKind::acceleration:
    case ConditionKind::own:
      return {.inner = 1, .outer = 2, .slope = 3, .scale = half_h, .value = condition.value};
    case ConditionKind::not_a_knot:
      return not_a_knot_row(at);
    case ConditionKind::velocity:
    case ConditionKind::clamped:
    case ConditionKind::halt:
    case ConditionKind::periodic:  // the caller passes velocities instead
      break;
  }
  return {.inner = 0, .outer = 1, .slope = 0, .scale = 1, .value = condition.value};
}

void solve_end_row(const EndRow& row, std::span<const double> chord, double gamma_before,
                   std::span<const double> g_before, std::span<double> v) noexcept {
  const double pivot = row.outer - row.inner * gamma_before;
  for (std::size_t d = 0; d < v.size(); ++d) {
    v[d] = (row.right_side(chord[d], d) - row.inner * g_before[d]) / pivot;
  }
}

}  // namespace

double eliminate_first(const Condition& start, const EndIntervals& at,
                       std::span<double> g) noexcept {
  const EndRow row = end_row(start, at, Side::start);
  for (std::size_t d = 0; d < g.size(); ++d) g[d] = row.right_side(at.chord[d], d) / row.outer;
  return row.inner / row.outer;
}

SPLINECAST_VECTOR_CLONES
double eliminate_interior(const Neighbours& neighbours, double gamma_before,
                          std::span<const double> g_before, std::span<double> g) noexcept {
  const InteriorRow row(neighbours.h_before, neighbours.h_after, gamma_before);
  for_lanes(g.size(), [&](auto lane, std::size_t first) {
    using Lane = typename decltype(lane)::type;
    store_lane(g.data() + first, row.g(load_lane<Lane>(neighbours.chord_before.data() + first),
                                       load_lane<Lane>(neighbours.chord_after.data() + first),
                                       load_lane<Lane>(g_before.data() + first)));
  });
  return row.gamma();
}

void solve_last(const Condition& end, const EndIntervals& at, double gamma_before,
                std::span<const double> g_before, std::span<double> v) noexcept {
  solve_end_row(end_row(end, at, Side::end), at.chord, gamma_before, g_before, v);
}

void solve_tail(Tail tail, const EndIntervals& at, double gamma_before,
                std::span<const double> g_before, std::span<double> v) noexcept {
  const bool has_next = at.h_next > 0;
  if (tail == Tail::bessel && !has_next) {
    std::ranges::copy(at.chord, v.begin());
    return;
  }
  const TailRow row(tail, at.h, at.h_next, gamma_before);
  const auto chord_next = has_next ? at.chord_next : at.chord;
  for (std::size_t d = 0; d < v.size(); ++d) {
    v[d] = row.velocity(at.chord[d], chord_next[d], g_before[d]);
  }
}

void back_substitute(double gamma, std::span<const double> g, std::span<const double> v_after,
                     std::span<double> v) noexcept {
  for (std::size_t d = 0; d < v.size(); ++d) v[d] = back_substituted(gamma, g[d], v_after[d]);
}

}  // namespace splinecast::core
