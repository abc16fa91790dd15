#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "tests/campaign/motions/motion.hpp"

namespace splinecast::campaign {

/// A motion of six joints. Each is the sum of two sines; the peaks over all joints are given.
class Sines final : public Motion {
 public:
  static constexpr std::size_t kJoints = 6;
  static constexpr double kPeakVelocity = 1.1;      ///< rad/s
  static constexpr double kPeakAcceleration = 1.4;  ///< rad/s²
  static constexpr double kSeconds = 20;            ///< duration, also for the peaks

  explicit Sines(std::uint64_t seed);

  [[nodiscard]] std::size_t joints() const noexcept override { return kJoints; }
  [[nodiscard]] double seconds() const noexcept override { return kSeconds; }
  [[nodiscard]] double at(std::size_t joint, double t, int derivative = 0) const noexcept override;
  /// The largest of 1,000 values per second.
  [[nodiscard]] double peak(std::size_t joint, int derivative) const noexcept override;

 private:
  struct Sine {
    double amplitude;
    double frequency;  ///< rad/s
    double phase;
  };
  [[nodiscard]] double peak_of_all(int derivative) const noexcept;

  std::array<std::array<Sine, 2>, kJoints> sines_{};
};

}  // namespace splinecast::campaign
