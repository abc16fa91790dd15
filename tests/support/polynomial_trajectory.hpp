#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "splinecast/core/time.hpp"
#include "support/mesh.hpp"

namespace splinecast::testing {

/// A trajectory of degree-7 polynomials in x, y, z and yaw, as quadrotor planners write it: an
/// exact oracle for positions and derivatives.
class PolynomialTrajectory {
 public:
  static constexpr std::size_t kDimensions = 4;

  explicit PolynomialTrajectory(const std::filesystem::path& csv);

  /// Length in seconds.
  [[nodiscard]] double duration() const;

  /// The given derivative (0: position) of each dimension at t seconds.
  [[nodiscard]] std::array<double, kDimensions> at(double t, int derivative) const;

  /// Positions every `period`, from 0 to the last multiple within the trajectory.
  [[nodiscard]] Mesh sampled(core::Time period) const;

 private:
  struct Piece {
    double duration;
    std::array<std::array<double, 8>, kDimensions> coefficients;
  };
  std::vector<Piece> pieces_;
};

}  // namespace splinecast::testing
