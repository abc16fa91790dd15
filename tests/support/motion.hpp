#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "splinecast/core/time.hpp"

namespace splinecast::testing {

/// The motion that a world's producer sends: a sum of two sines per dimension.
class Motion {
 public:
  static constexpr core::Time kStart = std::chrono::seconds(1000);  ///< where its time begins
  Motion(std::uint64_t seed, std::size_t dimensions);
  [[nodiscard]] std::size_t dimensions() const { return terms_.size() / 2; }
  /// The derivative-th derivative at t.
  [[nodiscard]] std::vector<double> at(core::Time t, int derivative = 0) const;
  /// A bound of the acceleration, per dimension.
  [[nodiscard]] std::vector<double> peak_acceleration() const;

 private:
  struct Term {
    double amplitude, frequency, phase;
  };
  std::vector<Term> terms_;
};

}  // namespace splinecast::testing
