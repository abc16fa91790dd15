#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace splinecast::apps::mcap {

/// Offset of the first chunk record in `file` from `begin` that ends by `end`; nothing if there is
/// none. Recognises it by its opcode, its lengths, which depend on each other, and its compression.
[[nodiscard]] std::optional<std::uint64_t> find_chunk(std::span<const std::byte> file,
                                                      std::uint64_t begin, std::uint64_t end);

}  // namespace splinecast::apps::mcap
