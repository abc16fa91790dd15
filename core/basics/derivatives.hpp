#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace splinecast::core {

/// A set of derivatives: what is wanted of a sample. Wherever they lie one behind the other, it is
/// in this order. The bit of the r-th derivative is 1 << r.
enum class Derivatives : std::uint8_t {
  none = 0,
  position = 1,
  velocity = 2,
  acceleration = 4,
  jerk = 8,
  all = 15,
};

[[nodiscard]] constexpr Derivatives operator|(Derivatives a, Derivatives b) noexcept {
  return static_cast<Derivatives>(static_cast<std::uint8_t>(a) | static_cast<std::uint8_t>(b));
}

/// Whether `set` has all of `wanted`.
[[nodiscard]] constexpr bool contains(Derivatives set, Derivatives wanted) noexcept {
  return (set | wanted) == set;
}

/// How many derivatives there are in the set: 0 … 4.
[[nodiscard]] constexpr std::size_t count(Derivatives set) noexcept {
  return static_cast<std::size_t>(std::popcount(static_cast<std::uint8_t>(set)));
}

}  // namespace splinecast::core
