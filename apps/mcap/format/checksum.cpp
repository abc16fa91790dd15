#include "apps/mcap/format/checksum.hpp"

#include <zlib.h>

#include "apps/mcap/format/compression.hpp"

namespace splinecast::apps::mcap {

std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before) {
  const auto* const begin =
      reinterpret_cast<const Bytef*>(bytes.data());  // NOLINT(*-reinterpret-cast)
  return bytes.empty() ? before : static_cast<std::uint32_t>(crc32_z(before, begin, bytes.size()));
}

void require_mcap() {}

}  // namespace splinecast::apps::mcap
