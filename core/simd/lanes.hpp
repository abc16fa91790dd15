#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <type_traits>

namespace splinecast::core {

/// Values of consecutive dimensions, for one or two vector registers.
using FourLanes [[gnu::vector_size(4 * sizeof(double))]] = double;
using TwoLanes [[gnu::vector_size(2 * sizeof(double))]] = double;

template <typename Lane>
inline constexpr std::size_t kWidth = sizeof(Lane) / sizeof(double);

/// Calls `body(lane, first)` so that each dimension is covered once, four at a time, then two, then
/// one: `decltype(lane)::type` is FourLanes, TwoLanes or double, and the body handles as many
/// dimensions as it holds, from `first` on. This avoids the setup of a loop over few values, and
/// each dimension goes through the same operations in all cases. All bodies of for_lanes divide an
/// array in the same way, so that a load has the size of the store before it and the processor can
/// forward the value.
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

/// The same, but always four at a time if there are four or more: the last four overlap those
/// before. Only for bodies that do not read what a body writes.
template <typename Body>
[[gnu::always_inline]] inline void for_overlapping_lanes(std::size_t dimensions,
                                                         const Body& body) noexcept {
  if (dimensions < 4) return for_lanes(dimensions, body);
  std::size_t first = 0;
  for (; first + 4 <= dimensions; first += 4) body(std::type_identity<FourLanes>{}, first);
  if (first < dimensions) body(std::type_identity<FourLanes>{}, dimensions - 4);
}

/// Calls `body(lane, groups, first)` so that arrays whose length is padded to 2 or to a multiple of
/// 4 are covered once, without a remainder: `decltype(groups)::value` contiguous lanes of the type
/// `decltype(lane)::type` begin at `first`. Uses two lanes at once if there are enough values, so
/// that values shared by all dimensions are loaded half as often.
template <typename Body>
[[gnu::always_inline]] inline void for_padded_lanes(std::size_t padded, const Body& body) noexcept {
  using One = std::integral_constant<std::size_t, 1>;
  using Two = std::integral_constant<std::size_t, 2>;
  if (padded == 2) return body(std::type_identity<TwoLanes>{}, One{}, 0);
  std::size_t first = 0;
  for (; first + 8 <= padded; first += 8) body(std::type_identity<FourLanes>{}, Two{}, first);
  if (first < padded) body(std::type_identity<FourLanes>{}, One{}, first);
}

/// Loads a lane from an array, and stores one to an array.
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

/// The magnitudes of the values of a lane, and the sum of the values.
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

/// Loads a lane from an array that ends after `count` (≥ 1) values, which may be fewer than those
/// of the lane: the others are 0.
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
