#pragma once

#include <cstddef>
#include <span>

#include "core/solvers/smoothing_rows.hpp"

/// The rows of the smoothing spline (Reinsch): f minimises Σ(x_i − f(t_i))² + λ∫f″².
///
/// With a_j = f″(t_j) at the interior knots, (R + λQᵀQ) a = Qᵀx and f = x − λQa, where (Qᵀx)_j =
/// m_j − m_{j−1}. The matrix is pentadiagonal, symmetric and positive definite: LDLᵀ from the left.
/// Row j needs the knots up to j+1 only, so it is final as soon as waypoint j+1 arrives. Its
/// scalars are shared by all dimensions; z = L⁻¹Qᵀx has one value per dimension. Outside rows 1 …
/// n−1 the factors have their default values and a is 0: the natural ends. Nothing allocates or
/// throws.
///
/// The condition number grows like min(λ/h³, n⁴). A window keeps it small and computes in doubles;
/// the batch solver has all knots at once and computes in DoubleDouble.
namespace splinecast::core {

/// Lengths, in seconds, of the intervals before and after the knot of row j, and of the one before
/// those (any value if there is none).
struct SmoothingIntervals {
  double h_before2;
  double h_before;
  double h_after;
};

/// Row j of QᵀQ up to its diagonal: (j,j), (j−1,j) and (j−2,j). The last two are used only if those
/// rows exist.
template <typename Real>
struct RoughnessRow {
  Real diagonal = 0;
  Real neighbour = 0;
  Real second = 0;
};

template <typename Real>
RoughnessRow<Real> roughness_row(const SmoothingIntervals& at) noexcept {
  const Real before2 = Real(1) / at.h_before2;
  const Real before = Real(1) / at.h_before;
  const Real after = Real(1) / at.h_after;
  return {.diagonal = before * before + (before + after) * (before + after) + after * after,
          .neighbour = -(before * (before2 + Real(2) * before + after)),
          .second = before2 * before};
}

/// Factors row j, given the two rows before it.
template <typename Real>
SmoothingFactors<Real> factor_smoothing(double lambda, const SmoothingIntervals& at,
                                        const RoughnessRow<Real>& roughness,
                                        const SmoothingFactors<Real>& before2,
                                        const SmoothingFactors<Real>& before) noexcept {
  SmoothingFactors<Real> row;
  row.pivot = (Real(at.h_before) + at.h_after) / 3 + lambda * roughness.diagonal;
  if (before.pivot == Real(0)) return row;
  Real neighbour = Real(at.h_before) / 6 + lambda * roughness.neighbour;
  if (before2.pivot > Real(0)) {
    const Real second = lambda * roughness.second;
    row.lower2 = second / before2.pivot;
    row.pivot = row.pivot - row.lower2 * second;
    neighbour = neighbour - second * before.lower1;
  }
  row.lower1 = neighbour / before.pivot;
  row.pivot = row.pivot - row.lower1 * neighbour;
  return row;
}

/// z of row j in one dimension, from the chord slopes around its knot and z of the rows before it.
template <typename Real>
Real eliminate_smoothing(const SmoothingFactors<Real>& row, double chord_before, double chord_after,
                         Real z_before2, Real z_before) noexcept {
  return Real(chord_after) - chord_before - row.lower1 * z_before - row.lower2 * z_before2;
}

/// a_j from z_j and the next two accelerations; `after` and `after2` are their rows.
template <typename Real>
Real back_substitute_smoothing(const SmoothingFactors<Real>& row,
                               const SmoothingFactors<Real>& after,
                               const SmoothingFactors<Real>& after2, Real z, Real a_after,
                               Real a_after2) noexcept {
  return z / row.pivot - after.lower1 * a_after - after2.lower2 * a_after2;
}

/// λ(Qa)_i = x_i − f(t_i), the offset of a waypoint from the curve. A missing interval has length
/// 0.
template <typename Real>
Real smoothing_residual(double lambda, double h_before, double h_after, Real a_before, Real a,
                        Real a_after) noexcept {
  Real jerk_change = 0;
  if (h_after > 0) jerk_change = jerk_change + (a_after - a) / h_after;
  if (h_before > 0) jerk_change = jerk_change - (a - a_before) / h_before;
  return lambda * jerk_change;
}

}  // namespace splinecast::core
