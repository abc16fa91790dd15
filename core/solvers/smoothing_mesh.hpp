#pragma once

#include <vector>

#include "core/basics/double_double.hpp"
#include "core/solvers/knot_ring.hpp"
#include "core/solvers/smoothing_system.hpp"

namespace splinecast::core {

/// The intervals around knot j ≥ 1. Row 1 has no second interval before it: uses that of row 0.
[[nodiscard]] SmoothingIntervals smoothing_intervals(const KnotRing& knots, std::size_t j) noexcept;

/// The part of the smoothing spline's system that depends on its mesh only, for any λ. The ring
/// must have measured its intervals and must outlive this object. O(n).
class SmoothingMesh {
 public:
  explicit SmoothingMesh(const KnotRing& knots);

  [[nodiscard]] const KnotRing& knots() const noexcept { return knots_; }
  [[nodiscard]] const RoughnessRow<DoubleDouble>& roughness(std::size_t j) const noexcept {
    return roughness_[j];
  }

 private:
  const KnotRing& knots_;
  std::vector<RoughnessRow<DoubleDouble>> roughness_;  ///< of knots 0 … n−1; row 0 is unused
};

/// The smoothing spline of all knots at once, in twice the precision of a double. The mesh must
/// outlive this object. O(n) to construct, O(n) per dimension.
class BatchSmoothing {
 public:
  BatchSmoothing(const SmoothingMesh& mesh, double lambda);

  /// Accelerations and residuals x − f of one dimension, all knots.
  struct Solution {
    std::vector<DoubleDouble> acceleration;
    std::vector<DoubleDouble> residual;
  };
  [[nodiscard]] Solution solve(std::size_t dimension) const;

  /// tr(I − H), with the matrix H that maps waypoints to positions.
  [[nodiscard]] double residual_trace() const;

 private:
  [[nodiscard]] SmoothingFactors<DoubleDouble> row(std::size_t j) const noexcept {
    return j < rows_.size() ? rows_[j] : SmoothingFactors<DoubleDouble>{};
  }

  const SmoothingMesh& mesh_;
  double lambda_;
  std::vector<SmoothingFactors<DoubleDouble>> rows_;  ///< of knots 0 … n−1; row 0 is unused
};

}  // namespace splinecast::core
