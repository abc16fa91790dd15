#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace splinecast::apps::mcap {

/// Compression of the chunks of a file.
enum class Compression : std::uint8_t { none, lz4, zstd };

/// The word that a chunk has for a compression: `lz4`, `zstd`, or nothing for none.
[[nodiscard]] std::string_view word_of(Compression compression) noexcept;

/// The compression of a chunk with this word; nothing if the word is unknown.
[[nodiscard]] std::optional<Compression> compression_of(std::string_view word) noexcept;

/// Throws Failure if this program was built without the libraries for MCAP.
void require_mcap();

}  // namespace splinecast::apps::mcap
