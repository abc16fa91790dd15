#include "support/motion.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace splinecast::testing {

using core::Time;

namespace {

/// When the motion starts, s.
constexpr double kFirst = 0.1;

}  // namespace

Motion::Motion(std::uint64_t seed, std::size_t dimensions) {
  std::mt19937_64 random(seed * 977 + 1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::size_t i = 0; i < 2 * dimensions; ++i) {
    // At rest where the stream starts.
    const double frequency = 3 + 3 * unit(random);
    terms_.push_back({0.2 + unit(random), frequency, std::acos(0.0) - frequency * kFirst});
  }
}

std::vector<double> Motion::at(Time t, int derivative) const {
  std::vector<double> x(dimensions());
  const double s = core::to_seconds(t - kStart);
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const Term& term = terms_[i];
    x[i / 2] += term.amplitude * std::pow(term.frequency, derivative) *
                std::sin(term.frequency * s + term.phase + derivative * std::acos(0.0));
  }
  return x;
}

std::vector<double> Motion::peak_acceleration() const {
  std::vector<double> peak(dimensions());
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    peak[i / 2] += terms_[i].amplitude * terms_[i].frequency * terms_[i].frequency;
  }
  return peak;
}

}  // namespace splinecast::testing
