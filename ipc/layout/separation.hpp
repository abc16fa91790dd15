#pragma once

#include <cstddef>

#include "ipc/memory/word.hpp"

namespace splinecast::ipc {

/// What different processes write, or poll, lies this far apart: two cache lines, because adjacent
/// lines are fetched in pairs.
inline constexpr std::size_t kSeparation = 128;
inline constexpr std::size_t kCacheLine = 64;
inline constexpr std::size_t kPage = 4096;

/// Words that what is polled takes, so that what comes behind it lies apart.
inline constexpr std::size_t kLineWords = kSeparation / sizeof(Word);

/// The least multiple that is not below a value.
[[nodiscard]] constexpr std::size_t round_up(std::size_t value, std::size_t multiple) noexcept {
  return (value + multiple - 1) / multiple * multiple;
}

}  // namespace splinecast::ipc
