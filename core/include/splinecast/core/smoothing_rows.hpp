#pragma once

#include <span>

/// The rows of the smoothing spline (Reinsch): f minimises Σ(x_i − f(t_i))² + λ∫f″².
///
/// With a_j = f″(t_j) at the interior knots, (R + λQᵀQ) a = Qᵀx and f = x − λQa, where
/// (Qᵀx)_j = m_j − m_{j−1}. The matrix is pentadiagonal, symmetric and positive definite: LDLᵀ from
/// the left. Row j needs the knots up to j+1 only, so it is final as soon as waypoint j+1 has come.
/// Its scalars are shared by all dimensions; z = L⁻¹Qᵀx has one value per dimension. Outside rows
/// 1 … n−1 there is a default SmoothingRow, and a is 0: the natural ends. Every function is O(D),
/// allocates nothing and throws nothing.
namespace splinecast::core {

/// Row j of the factors: D_jj, L_{j,j−1} and L_{j,j−2}.
struct SmoothingRow {
  double pivot = 0;  ///< > 0; 0: there is no such row
  double lower1 = 0;
  double lower2 = 0;
};

/// Lengths, in seconds, of the intervals before and after the knot of row j, and of the one before
/// those (any value where there is none).
struct SmoothingIntervals {
  double h_before2;
  double h_before;
  double h_after;
};

/// (QᵀQ)_{j,j}.
[[nodiscard]] double roughness_diagonal(double h_before, double h_after) noexcept;
/// (QᵀQ)_{j−1,j}; all three intervals must be there.
[[nodiscard]] double roughness_neighbour(const SmoothingIntervals& at) noexcept;
/// (QᵀQ)_{j−2,j}.
[[nodiscard]] double roughness_second_neighbour(const SmoothingIntervals& at) noexcept;

/// Factors row j, given the two rows before it.
[[nodiscard]] SmoothingRow factor_smoothing(double lambda, const SmoothingIntervals& at,
                                            const SmoothingRow& before2,
                                            const SmoothingRow& before) noexcept;

/// Writes z of row j from the chord slopes around its knot and z of the two rows before it.
void eliminate_smoothing(const SmoothingRow& row, std::span<const double> chord_before,
                         std::span<const double> chord_after, std::span<const double> z_before2,
                         std::span<const double> z_before, std::span<double> z) noexcept;

/// Writes a_j from z_j and the two accelerations behind it; `after` and `after2` are their rows.
void back_substitute_smoothing(const SmoothingRow& row, const SmoothingRow& after,
                               const SmoothingRow& after2, std::span<const double> z,
                               std::span<const double> a_after, std::span<const double> a_after2,
                               std::span<double> a) noexcept;

/// Writes the position on the curve, f = x − λ((a_after − a)/h_after − (a − a_before)/h_before); an
/// interval that is not there has length 0.
void smooth_position(double lambda, double h_before, double h_after, std::span<const double> x,
                     std::span<const double> a_before, std::span<const double> a,
                     std::span<const double> a_after, std::span<double> f) noexcept;

/// The settle lag that leaves an acceleration step of about 1e-3 of the peak acceleration (up to
/// 1e-2 where the waypoints are mostly noise), for knots `mean_interval`
/// seconds apart: 13·max(1, (λ/h³)^¼). May be more than any window offers.
[[nodiscard]] double smoothing_lag(double lambda, double mean_interval) noexcept;

}  // namespace splinecast::core
