#include "splinecast/core/tridiagonal.hpp"

#include <algorithm>
#include <cstddef>

namespace splinecast::core {
namespace {

/// Which way an end row looks at its interval: the acceleration changes sign in the mirror.
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

/// Natural is the acceleration row with a = 0, rest and halt the velocity row with v = 0
/// (doc 003 eq 4-13, 4-19; doc 000 eq 4.14, 4.15).
EndRow end_row(const Condition& condition, double h, Side side) noexcept {
  const double half_h = side == Side::start ? -h / 2 : h / 2;
  switch (condition.kind) {
    case ConditionKind::natural:
    case ConditionKind::acceleration:
      return {.inner = 1, .outer = 2, .slope = 3, .scale = half_h, .value = condition.value};
    case ConditionKind::velocity:
    case ConditionKind::rest:
    case ConditionKind::halt:
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

/// Slope at the newest knot of the parabola through the last three waypoints.
void parabola_slope(const Neighbours& last_two, std::span<double> v) noexcept {
  const double weight = last_two.h_after / (last_two.h_before + last_two.h_after);
  for (std::size_t d = 0; d < v.size(); ++d) {
    const double m = last_two.chord_after[d];
    v[d] = m + weight * (m - last_two.chord_before[d]);
  }
}

}  // namespace

double eliminate_first(const Condition& start, double h, std::span<const double> chord,
                       std::span<double> g) noexcept {
  const EndRow row = end_row(start, h, Side::start);
  for (std::size_t d = 0; d < g.size(); ++d) g[d] = row.right_side(chord[d], d) / row.outer;
  return row.inner / row.outer;
}

double eliminate_interior(const Neighbours& neighbours, double gamma_before,
                          std::span<const double> g_before, std::span<double> g) noexcept {
  const double before = neighbours.h_before;
  const double after = neighbours.h_after;
  const double pivot = 2 * (before + after) - after * gamma_before;
  for (std::size_t d = 0; d < g.size(); ++d) {
    const double right_side =
        3 * (after * neighbours.chord_before[d] + before * neighbours.chord_after[d]);
    g[d] = (right_side - after * g_before[d]) / pivot;
  }
  return before / pivot;
}

void solve_last(const Condition& end, double h, std::span<const double> chord, double gamma_before,
                std::span<const double> g_before, std::span<double> v) noexcept {
  solve_end_row(end_row(end, h, Side::end), chord, gamma_before, g_before, v);
}

void solve_tail(Tail tail, const Neighbours& last_two, double gamma_before,
                std::span<const double> g_before, std::span<double> v) noexcept {
  const auto chord = last_two.chord_after;
  switch (tail) {
    case Tail::bessel:
      if (last_two.h_before > 0) {
        parabola_slope(last_two, v);
      } else {
        std::ranges::copy(chord, v.begin());
      }
      break;
    case Tail::parabolic:
      solve_end_row({.inner = 1, .outer = 1, .slope = 2, .scale = 0, .value = {}}, chord,
                    gamma_before, g_before, v);
      break;
    case Tail::natural:
      solve_last({.kind = ConditionKind::natural, .value = {}}, last_two.h_after, chord,
                 gamma_before, g_before, v);
      break;
    case Tail::rest:
      std::ranges::fill(v, 0.0);
      break;
  }
}

void back_substitute(double gamma, std::span<const double> g, std::span<const double> v_after,
                     std::span<double> v) noexcept {
  for (std::size_t d = 0; d < v.size(); ++d) v[d] = g[d] - gamma * v_after[d];
}

}  // namespace splinecast::core
