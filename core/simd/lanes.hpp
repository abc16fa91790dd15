#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <type_traits>

namespace splinecast::core {

/// Values of some dimensions side by side, for a vector register or two.
using FourLanes [[gnu::vector_size(4 * sizeof(double))]] = double;
using TwoLanes [[gnu::vector_size(2 * sizeof(double))]] = double;

template <typename Lane>
inline constexpr std::size_t kWidth = sizeof(Lane) / sizeof(double);

/// Calls `body(lane, first)` so that each dimension is covered once, four at a time, then two, then
/// one: `decltype(lane)::type` is FourLanes, TwoLanes or double, and the body works on the
/// dimensions from `first` on that it holds. There is no loop over a handful of values to set up,
/// and each dimension goes through the same operations either way. What one body stores, the next
/// one loads in the same pieces, so that a processor need not wait for the stores.
template <typename Body>
[[gnu::always_inline]] inline void for_lanes(std::size_t dimensions, const Body& body) noexcept {
  std::size_t first = 0;
  for (; first + 4 <= dimensions; first += 4) body(std::type_identity<FourLanes>{}, first);
  if ((dimensions & 2) != 0) {
    body(std::type_identity<TwoLanes>{}, first);
    first += 2;
  }
  if ((dimensions & 1) != 0) body(std::type_identity<double>{}, first);
}

/// Likewise, but four at a time wherever there are so many: the last four overlap those before. For
/// bodies that write nothing that they, or another body, read.
template <typename Body>
[[gnu::always_inline]] inline void for_overlapping_lanes(std::size_t dimensions,
                                                         const Body& body) noexcept {
  if (dimensions < 4) return for_lanes(dimensions, body);
  std::size_t first = 0;
  for (; first + 4 <= dimensions; first += 4) body(std::type_identity<FourLanes>{}, first);
  if (first < dimensions) body(std::type_identity<FourLanes>{}, dimensions - 4);
}

/// Calls `body(lane, groups, first)` so that arrays whose length has been padded to 2 or to a
/// multiple of 4 are covered once, without a remainder: `decltype(groups)::value` lanes of the type
/// `decltype(lane)::type` begin at `first`, one behind the other. Two at once where there are so
/// many: what all dimensions share is then loaded half as often.
template <typename Body>
[[gnu::always_inline]] inline void for_padded_lanes(std::size_t padded, const Body& body) noexcept {
  using One = std::integral_constant<std::size_t, 1>;
  using Two = std::integral_constant<std::size_t, 2>;
  if (padded == 2) return body(std::type_identity<TwoLanes>{}, One{}, 0);
  std::size_t first = 0;
  for (; first + 8 <= padded; first += 8) body(std::type_identity<FourLanes>{}, Two{}, first);
  if (first < padded) body(std::type_identity<FourLanes>{}, One{}, first);
}

/// What a body reads of an array, and writes to one.
template <typename Lane>
[[gnu::always_inline]] inline Lane load_lane(const double* from) noexcept {
  Lane value;
  std::memcpy(&value, from, sizeof(Lane));
  return value;
}
template <typename Lane>
[[gnu::always_inline]] inline void store_lane(double* to, Lane value) noexcept {
  std::memcpy(to, &value, sizeof(Lane));
}

/// Magnitudes, and the sum of what a lane holds.
template <typename Lane>
[[gnu::always_inline]] inline Lane without_sign(Lane values) noexcept {
  if constexpr (std::is_same_v<Lane, double>) {
    return std::abs(values);
  } else {
    using Bits [[gnu::vector_size(sizeof(Lane))]] = long long;
    const Bits bits = reinterpret_cast<Bits>(values);  // NOLINT(*-reinterpret-cast)
    return reinterpret_cast<Lane>(                     // NOLINT(*-reinterpret-cast)
        bits & std::numeric_limits<long long>::max());
  }
}
template <typename Lane>
[[gnu::always_inline]] inline double sum_of_lane(Lane values) noexcept {
  if constexpr (kWidth<Lane> == 4) return values[0] + values[1] + (values[2] + values[3]);
  if constexpr (kWidth<Lane> == 2) return values[0] + values[1];
  if constexpr (kWidth<Lane> == 1) return values;
}

/// A lane of an array that ends after `count` (≥ 1) values, which may be fewer than the lane's:
/// zeros stand for the others.
template <typename Lane>
[[gnu::always_inline]] inline Lane load_first_of_lane(const double* from,
                                                      std::size_t count) noexcept {
  if (count >= kWidth<Lane>) return load_lane<Lane>(from);
  if constexpr (kWidth<Lane> == 2) return Lane{from[0]};
  if constexpr (kWidth<Lane> == 4) {
    if (count == 3) return Lane{from[0], from[1], from[2]};
    if (count == 2) return Lane{from[0], from[1]};
    return Lane{from[0]};
  }
}

}  // namespace splinecast::core
