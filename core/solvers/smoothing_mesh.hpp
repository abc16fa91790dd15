#pragma once

#include <vector>

#include "core/basics/double_double.hpp"
#include "core/solvers/knot_ring.hpp"
#include "core/solvers/smoothing_system.hpp"

namespace splinecast::core {

/// The intervals around knot j ≥ 1. Row 1 has none before: that of row 0 stands in.
[[nodiscard]] SmoothingIntervals smoothing_intervals(const KnotRing& knots, std::size_t j) noexcept;

/// What the smoothing spline's system has of its mesh alone, for any λ. The ring must have measured
/// its intervals and live on. O(n).
class SmoothingMesh {
 public:
  explicit SmoothingMesh(const KnotRing& knots);

  [[nodiscard]] const KnotRing& knots() const noexcept { return knots_; }
  [[nodiscard]] const RoughnessRow<DoubleDouble>& roughness(std::size_t j) const noexcept {
    return roughness_[j];
  }

 private:
  const KnotRing& knots_;
  std::vector<RoughnessRow<DoubleDouble>> roughness_;  ///< of knots 0 … n−1; row 0 is none
};

/// The smoothing spline of all knots at once, in twice a double's precision. The mesh must live on.
/// O(n) to make, O(n) a dimension.
class BatchSmoothing {
 public:
  BatchSmoothing(const SmoothingMesh& mesh, double lambda);

  /// Accelerations and residuals x − f of one dimension, all knots.
  struct Solution {
    std::vector<DoubleDouble> acceleration;
    std::vector<DoubleDouble> residual;
  };
  [[nodiscard]] Solution solve(std::size_t dimension) const;

  /// tr(I − H), H being the matrix that takes waypoints to positions.
  [[nodiscard]] double residual_trace() const;

 private:
  [[nodiscard]] SmoothingFactors<DoubleDouble> row(std::size_t j) const noexcept {
    return j < rows_.size() ? rows_[j] : SmoothingFactors<DoubleDouble>{};
  }

  const SmoothingMesh& mesh_;
  double lambda_;
  std::vector<SmoothingFactors<DoubleDouble>> rows_;  ///< of knots 0 … n−1; row 0 is none
};

}  // namespace splinecast::core
