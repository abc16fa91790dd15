#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace splinecast::campaign {

/// A motion of six joints, each the sum of two sines, of given peaks over all joints.
class Sines {
 public:
  static constexpr std::size_t kJoints = 6;
  static constexpr double kPeakVelocity = 1.1;      ///< rad/s
  static constexpr double kPeakAcceleration = 1.4;  ///< rad/s²
  static constexpr double kSeconds = 20;            ///< over which the peaks are taken

  explicit Sines(std::uint64_t seed);

  /// A joint's position in rad, or a derivative of it, at a time in s.
  [[nodiscard]] double at(std::size_t joint, double t, int derivative = 0) const noexcept;
  [[nodiscard]] std::vector<double> positions(double t) const;

 private:
  struct Sine {
    double amplitude;
    double frequency;  ///< rad/s
    double phase;
  };
  [[nodiscard]] double peak(int derivative) const noexcept;

  std::array<std::array<Sine, 2>, kJoints> sines_{};
};

}  // namespace splinecast::campaign
