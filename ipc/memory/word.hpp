#pragma once

#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ipc/memory/store_hook.hpp"
#include "splinecast/time.hpp"

/// Shared memory consists of 64-bit words. Every access to a word that another process may write is
/// atomic: no plain memory is shared, so that there is no data race.
namespace splinecast::ipc {

using Word = std::uint64_t;
static_assert(std::atomic_ref<Word>::is_always_lock_free);
static_assert(sizeof(double) == sizeof(Word));

#ifdef SPLINECAST_PLAIN_WORD
/// In a special build of this library for a test: the word that load() and store() access without
/// an atomic. ThreadSanitizer must report it.
inline const Word* plain_word = nullptr;
#endif

/// Loads a word; the mapping may be read-only. The const_cast is necessary because C++20 has no
/// std::atomic_ref<const T>, and safe because a lock-free 64-bit load stores nothing.
[[nodiscard]] inline Word load(const Word& word, std::memory_order order) noexcept {
#ifdef SPLINECAST_PLAIN_WORD
  if (&word == plain_word) return word;
#endif
  return std::atomic_ref<Word>(const_cast<Word&>(word)).load(order);  // NOLINT(*-const-cast)
}

/// Stores a word. Every store to a region that has a name uses this function.
inline void store(Word& word, Word value, std::memory_order order) noexcept {
#ifdef SPLINECAST_PLAIN_WORD
  if (&word == plain_word) {
    word = value;
    return;
  }
#endif
  before_store();
  std::atomic_ref<Word>(word).store(value, order);
}

[[nodiscard]] inline Word to_word(double value) noexcept { return std::bit_cast<Word>(value); }
[[nodiscard]] inline Word to_word(Time value) noexcept { return static_cast<Word>(value.count()); }
[[nodiscard]] inline double to_double(Word word) noexcept { return std::bit_cast<double>(word); }
[[nodiscard]] inline Time to_time(Word word) noexcept {
  return Time(static_cast<std::int64_t>(word));
}

inline constexpr std::size_t kCacheLine = 64;

/// Prefetches the cache lines of a memory range. Loads nothing.
inline void prefetch_lines(const void* from, std::size_t bytes) noexcept {
  const auto* const first = static_cast<const std::byte*>(from);
  for (std::size_t at = 0; at < bytes; at += kCacheLine) __builtin_prefetch(first + at);
}

/// Calls `copy(to[i], from[i])` for each i < n ≤ 8, with one jump.
template <typename To, typename From, typename Copy>
[[gnu::always_inline]] inline void copy_last(To* to, const From* from, std::size_t n,
                                             const Copy& copy) noexcept {
  switch (n) {
    case 8:
      copy(to[7], from[7]);
      [[fallthrough]];
    case 7:
      copy(to[6], from[6]);
      [[fallthrough]];
    case 6:
      copy(to[5], from[5]);
      [[fallthrough]];
    case 5:
      copy(to[4], from[4]);
      [[fallthrough]];
    case 4:
      copy(to[3], from[3]);
      [[fallthrough]];
    case 3:
      copy(to[2], from[2]);
      [[fallthrough]];
    case 2:
      copy(to[1], from[1]);
      [[fallthrough]];
    case 1:
      copy(to[0], from[0]);
      [[fallthrough]];
    default:
      break;
  }
}

/// Calls `copy(to[i], from[i])` for each i < n, in any order. Unrolled by eight; the last eight or
/// fewer take one jump instead of a test each.
template <typename To, typename From, typename Copy>
[[gnu::always_inline]] inline void copy_each(To* to, const From* from, std::size_t n,
                                             const Copy& copy) noexcept {
  for (; n > 8; n -= 8, to += 8, from += 8) {
    copy(to[0], from[0]);
    copy(to[1], from[1]);
    copy(to[2], from[2]);
    copy(to[3], from[3]);
    copy(to[4], from[4]);
    copy(to[5], from[5]);
    copy(to[6], from[6]);
    copy(to[7], from[7]);
  }
  copy_last(to, from, n, copy);
}

/// Stores values (release), one per word, from `to` on.
inline void store_values(Word* to, std::span<const double> values) noexcept {
  copy_each(to, values.data(), values.size(), [](Word& word, double value) {
    store(word, to_word(value), std::memory_order_release);
  });
}

/// Stores values as store_values does, and adds their magnitudes to `sum`, for a check of all
/// values at once: see core::magnitude_of.
inline void store_summed(Word* to, std::span<const double> values, double& sum) noexcept {
  double own = sum;
  copy_each(to, values.data(), values.size(), [&own](Word& word, double value) {
    store(word, to_word(value), std::memory_order_release);
    own += std::abs(value);
  });
  sum = own;
}

/// Loads values (acquire), one per word, from `from` on.
inline void load_values(std::span<double> values, const Word* from) noexcept {
  copy_each(values.data(), from, values.size(), [](double& value, const Word& word) {
    value = to_double(load(word, std::memory_order_acquire));
  });
}

/// A view of a part of a region as words. `offset` must be a multiple of 8, and all words must be
/// inside the region: the caller has checked the layout.
[[nodiscard]] inline std::span<Word> words_at(std::span<std::byte> region, std::size_t offset,
                                              std::size_t count) noexcept {
  return {reinterpret_cast<Word*>(region.data() + offset), count};  // NOLINT(*-reinterpret-cast)
}
[[nodiscard]] inline std::span<const Word> words_at(std::span<const std::byte> region,
                                                    std::size_t offset,
                                                    std::size_t count) noexcept {
  return {reinterpret_cast<const Word*>(region.data() + offset),  // NOLINT(*-reinterpret-cast)
          count};
}

}  // namespace splinecast::ipc
