#pragma once

namespace splinecast::core {

/// Row j of the factors LDLᵀ of the smoothing spline's system: D_jj, L_{j,j−1} and L_{j,j−2}.
template <typename Real>
struct SmoothingFactors {
  Real pivot = 0;  ///< > 0; 0: there is no such row
  Real lower1 = 0;
  Real lower2 = 0;
};
using SmoothingRow = SmoothingFactors<double>;

/// The settle lag 13·max(1, (λ/h³)^¼) for knots h = `mean_interval` seconds apart. It leaves an
/// acceleration step of about 1e-3 of the peak acceleration (up to 1e-2 if the waypoints are mostly
/// noise). May exceed the largest lag of a window.
[[nodiscard]] double smoothing_lag(double lambda, double mean_interval) noexcept;

}  // namespace splinecast::core
