#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace splinecast::apps {

/// Bytes as text.
[[nodiscard]] inline std::string_view text_of(std::span<const std::byte> bytes) noexcept {
  // NOLINTNEXTLINE(*-reinterpret-cast)
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Text as bytes.
[[nodiscard]] inline std::span<const std::byte> bytes_of(std::string_view text) noexcept {
  return std::as_bytes(std::span(text));
}

}  // namespace splinecast::apps
