#pragma once

#include <cstddef>

#include "ipc/memory/word.hpp"

namespace splinecast::ipc {

/// Distance in bytes between words that different processes write or poll: two cache lines, because
/// processors prefetch adjacent lines in pairs.
inline constexpr std::size_t kSeparation = 128;
inline constexpr std::size_t kPage = 4096;

/// The same distance in words.
inline constexpr std::size_t kSeparationWords = kSeparation / sizeof(Word);

/// The smallest multiple that is at least `value`.
[[nodiscard]] constexpr std::size_t round_up(std::size_t value, std::size_t multiple) noexcept {
  return (value + multiple - 1) / multiple * multiple;
}

}  // namespace splinecast::ipc
