#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "splinecast/time.hpp"

namespace splinecast::campaign {

/// Random numbers of one seed: SplitMix64, the same numbers with any compiler.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  [[nodiscard]] std::uint64_t next() noexcept {
    state_ += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }

  /// A number in [0, 1).
  [[nodiscard]] double unit() noexcept { return static_cast<double>(next() >> 11U) * 0x1p-53; }
  [[nodiscard]] double uniform(double low, double high) noexcept {
    return low + (high - low) * unit();
  }
  /// A number whose logarithm is uniform; 0 < low ≤ high.
  [[nodiscard]] double log_uniform(double low, double high) noexcept {
    return low * std::pow(high / low, unit());
  }
  [[nodiscard]] bool chance(double probability) noexcept { return unit() < probability; }
  /// An integer from 0 to n − 1; n ≥ 1.
  [[nodiscard]] std::size_t below(std::size_t n) noexcept {
    return static_cast<std::size_t>(next() % n);
  }
  [[nodiscard]] Time between(Time low, Time high) noexcept {
    return low +
           Time(static_cast<std::int64_t>(unit() * static_cast<double>((high - low).count())));
  }
  /// `time` times a uniform factor from low to high.
  [[nodiscard]] Time part(Time time, double low, double high) noexcept {
    return Time(static_cast<std::int64_t>(static_cast<double>(time.count()) * uniform(low, high)));
  }

 private:
  std::uint64_t state_;
};

}  // namespace splinecast::campaign
