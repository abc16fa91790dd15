#pragma once

#include <span>

#include "splinecast/boundary_condition.hpp"

/// The rows of the C² cubic spline in velocity form, eliminated from the left (math 4, 6, 16).
///
/// After elimination a row reads v_i = g_i − γ_i v_{i+1}. γ is one scalar per knot, shared by all
/// dimensions; g has one value per dimension. A row needs the knots up to i+1 only, so it is final
/// as soon as waypoint i+1 arrives. 0 ≤ γ ≤ 1/2 on any mesh (after a `not_a_knot` start from row 2
/// on), and the matrix is diagonally dominant: no pivoting. A row of a local method has γ = 0.
/// Every function is O(D), allocates nothing and throws nothing; spans hold one value per
/// dimension.
namespace splinecast::core {

/// The interval at an end and the one next to it, inwards: lengths in seconds and chord slopes.
/// `h_next` is 0 if there is only one interval.
struct EndIntervals {
  double h;
  std::span<const double> chord;
  double h_next = 0;
  std::span<const double> chord_next{};
};

/// Eliminates row 0. `not_a_knot` needs both intervals. Writes g, returns γ.
[[nodiscard]] double eliminate_first(const Condition& start, const EndIntervals& at,
                                     std::span<double> g) noexcept;

/// Intervals around an interior knot: lengths in seconds and chord slopes.
struct Neighbours {
  double h_before;
  double h_after;
  std::span<const double> chord_before;
  std::span<const double> chord_after;
};

/// Eliminates an interior row, given the row before it. Writes g, returns γ.
[[nodiscard]] double eliminate_interior(const Neighbours& neighbours, double gamma_before,
                                        std::span<const double> g_before,
                                        std::span<double> g) noexcept;

/// Solves the last row for the velocity of the last knot, given the row before it.
/// `not_a_knot` needs both intervals.
void solve_last(const Condition& end, const EndIntervals& at, double gamma_before,
                std::span<const double> g_before, std::span<double> v) noexcept;

/// The same for the condition at the newest knot of a stream that continues.
void solve_tail(Tail tail, const EndIntervals& at, double gamma_before,
                std::span<const double> g_before, std::span<double> v) noexcept;

/// One row of the back-substitution: v = g − γ v_after. If γ is 0, v is g bit for bit.
void back_substitute(double gamma, std::span<const double> g, std::span<const double> v_after,
                     std::span<double> v) noexcept;

}  // namespace splinecast::core
