#include "tests/campaign/motions/sines.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace splinecast::campaign {

Sines::Sines(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  for (auto& joint : sines_) {
    const double slow = between(0.6, 1.1);
    const double fast = between(1.3, 1.9);
    joint = {Sine{0.8 / slow, slow, between(0, 2 * std::numbers::pi)},
             Sine{0.35 / fast, fast, between(0, 2 * std::numbers::pi)}};
  }
  // Scale time and amplitude so that both peaks have their given values.
  const double rate = kPeakAcceleration / kPeakVelocity * peak_of_all(1) / peak_of_all(2);
  for (auto& joint : sines_) {
    for (Sine& sine : joint) sine.frequency *= rate;
  }
  const double size = kPeakVelocity / peak_of_all(1);
  for (auto& joint : sines_) {
    for (Sine& sine : joint) sine.amplitude *= size;
  }
}

double Sines::at(std::size_t joint, double t, int derivative) const noexcept {
  double sum = 0;
  for (const Sine& sine : sines_[joint]) {
    const double turn = derivative * std::numbers::pi / 2;
    sum += sine.amplitude * std::pow(sine.frequency, derivative) *
           std::sin(sine.frequency * t + sine.phase + turn);
  }
  return sum;
}

double Sines::peak(std::size_t joint, int derivative) const noexcept {
  constexpr double kStep = 1e-3;
  double most = 0;
  for (double t = 0; t <= kSeconds; t += kStep) {
    most = std::max(most, std::abs(at(joint, t, derivative)));
  }
  return most;
}

double Sines::peak_of_all(int derivative) const noexcept {
  double most = 0;
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    most = std::max(most, peak(joint, derivative));
  }
  return most;
}

}  // namespace splinecast::campaign
