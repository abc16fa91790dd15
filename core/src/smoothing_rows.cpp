#include "splinecast/core/smoothing_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace splinecast::core {

double roughness_diagonal(double h_before, double h_after) noexcept {
  const double before = 1 / h_before;
  const double after = 1 / h_after;
  return before * before + (before + after) * (before + after) + after * after;
}

double roughness_neighbour(const SmoothingIntervals& at) noexcept {
  const double shared = 1 / at.h_before;
  return -shared * (1 / at.h_before2 + 2 * shared + 1 / at.h_after);
}

double roughness_second_neighbour(const SmoothingIntervals& at) noexcept {
  return 1 / (at.h_before2 * at.h_before);
}

SmoothingRow factor_smoothing(double lambda, const SmoothingIntervals& at,
                              const SmoothingRow& before2, const SmoothingRow& before) noexcept {
  SmoothingRow row;
  row.pivot = (at.h_before + at.h_after) / 3 + lambda * roughness_diagonal(at.h_before, at.h_after);
  if (before.pivot == 0) return row;
  double neighbour = at.h_before / 6 + lambda * roughness_neighbour(at);
  if (before2.pivot > 0) {
    const double second = lambda * roughness_second_neighbour(at);
    row.lower2 = second / before2.pivot;
    row.pivot -= row.lower2 * second;
    neighbour -= second * before.lower1;
  }
  row.lower1 = neighbour / before.pivot;
  row.pivot -= row.lower1 * neighbour;
  return row;
}

void eliminate_smoothing(const SmoothingRow& row, std::span<const double> chord_before,
                         std::span<const double> chord_after, std::span<const double> z_before2,
                         std::span<const double> z_before, std::span<double> z) noexcept {
  for (std::size_t d = 0; d < z.size(); ++d) {
    z[d] = chord_after[d] - chord_before[d] - row.lower1 * z_before[d] - row.lower2 * z_before2[d];
  }
}

void back_substitute_smoothing(const SmoothingRow& row, const SmoothingRow& after,
                               const SmoothingRow& after2, std::span<const double> z,
                               std::span<const double> a_after, std::span<const double> a_after2,
                               std::span<double> a) noexcept {
  for (std::size_t d = 0; d < a.size(); ++d) {
    a[d] = z[d] / row.pivot - after.lower1 * a_after[d] - after2.lower2 * a_after2[d];
  }
}

void smooth_position(double lambda, double h_before, double h_after, std::span<const double> x,
                     std::span<const double> a_before, std::span<const double> a,
                     std::span<const double> a_after, std::span<double> f) noexcept {
  for (std::size_t d = 0; d < f.size(); ++d) {
    double jerk_change = 0;
    if (h_after > 0) jerk_change += (a_after[d] - a[d]) / h_after;
    if (h_before > 0) jerk_change -= (a[d] - a_before[d]) / h_before;
    f[d] = x[d] - lambda * jerk_change;
  }
}

double smoothing_lag(double lambda, double mean_interval) noexcept {
  const double ratio = lambda / (mean_interval * mean_interval * mean_interval);
  return 13 * std::max(1.0, std::sqrt(std::sqrt(ratio)));
}

}  // namespace splinecast::core
