#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace splinecast::apps::mcap {

/// CRC-32 (of zlib and PNG) of the bytes, which continue those of `before`.
[[nodiscard]] std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before = 0);

}  // namespace splinecast::apps::mcap
