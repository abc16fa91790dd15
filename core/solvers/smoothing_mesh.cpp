#include "core/solvers/smoothing_mesh.hpp"

namespace splinecast::core {

SmoothingIntervals smoothing_intervals(const KnotRing& knots, std::size_t j) noexcept {
  return {.h_before2 = knots.row(j > 1 ? j - 2 : 0).h,
          .h_before = knots.row(j - 1).h,
          .h_after = knots.row(j).h};
}

SmoothingMesh::SmoothingMesh(const KnotRing& knots) : knots_(knots), roughness_(knots.newest()) {
  for (std::size_t j = 1; j < roughness_.size(); ++j) {
    roughness_[j] = roughness_row<DoubleDouble>(smoothing_intervals(knots_, j));
  }
}

BatchSmoothing::BatchSmoothing(const SmoothingMesh& mesh, double lambda)
    : mesh_(mesh), lambda_(lambda), rows_(mesh.knots().newest()) {
  for (std::size_t j = 1; j < rows_.size(); ++j) {
    rows_[j] = factor_smoothing(lambda_, smoothing_intervals(mesh_.knots(), j), mesh_.roughness(j),
                                rows_[j > 1 ? j - 2 : 0], rows_[j - 1]);
  }
}

BatchSmoothing::Solution BatchSmoothing::solve(std::size_t dimension) const {
  const KnotRing& knots = mesh_.knots();
  const std::size_t n = knots.newest();
  const auto chord = [&](std::size_t i) { return knots.values(i, KnotRing::kChord)[dimension]; };
  const auto h = [&](std::size_t i) { return knots.row(i).h; };
  std::vector<DoubleDouble> z(n + 1);
  for (std::size_t j = 1; j < n; ++j) {
    z[j] = eliminate_smoothing(rows_[j], chord(j - 1), chord(j), j > 1 ? z[j - 2] : z[0], z[j - 1]);
  }
  Solution solution{.acceleration = std::vector<DoubleDouble>(n + 1),
                    .residual = std::vector<DoubleDouble>(n + 1)};
  auto& a = solution.acceleration;
  for (std::size_t j = n; j-- > 1;) {
    a[j] = back_substitute_smoothing(row(j), row(j + 1), row(j + 2), z[j], a[j + 1],
                                     j + 2 <= n ? a[j + 2] : DoubleDouble());
  }
  for (std::size_t i = 0; i <= n; ++i) {
    solution.residual[i] = smoothing_residual(lambda_, i > 0 ? h(i - 1) : 0, i < n ? h(i) : 0,
                                              i > 0 ? a[i - 1] : DoubleDouble(), a[i],
                                              i < n ? a[i + 1] : DoubleDouble());
  }
  return solution;
}

/// λ tr(A⁻¹QᵀQ) with A = R + λQᵀQ. Only the band of A⁻¹ is needed; it follows from LDLᵀ by a
/// recursion from the right (Hutchinson and de Hoog 1985).
double BatchSmoothing::residual_trace() const {
  struct Band {
    DoubleDouble diagonal;
    DoubleDouble next;
    DoubleDouble second;
  };
  const std::size_t n = rows_.size();
  Band after;
  Band after2;
  DoubleDouble trace;
  for (std::size_t j = n; j-- > 1;) {
    const DoubleDouble l1 = row(j + 1).lower1;
    const DoubleDouble l2 = row(j + 2).lower2;
    Band band;
    band.second = -(l1 * after.next) - l2 * after2.diagonal;
    band.next = -(l1 * after.diagonal) - l2 * after.next;
    band.diagonal = DoubleDouble(1) / row(j).pivot - l1 * band.next - l2 * band.second;
    trace += band.diagonal * mesh_.roughness(j).diagonal;
    if (j + 1 < n) trace += DoubleDouble(2) * band.next * mesh_.roughness(j + 1).neighbour;
    if (j + 2 < n) trace += DoubleDouble(2) * band.second * mesh_.roughness(j + 2).second;
    after2 = after;
    after = band;
  }
  return static_cast<double>(lambda_ * trace);
}

}  // namespace splinecast::core
