#include "apps/mcap/format/compression.hpp"

#include <array>

namespace splinecast::apps::mcap {
namespace {

constexpr std::array<std::string_view, 3> kWords{"", "lz4", "zstd"};

}  // namespace

std::string_view word_of(Compression compression) noexcept {
  return kWords.at(static_cast<std::size_t>(compression));
}

std::optional<Compression> compression_of(std::string_view word) noexcept {
  for (const auto compression : {Compression::none, Compression::lz4, Compression::zstd}) {
    if (word == word_of(compression)) return compression;
  }
  return std::nullopt;
}

}  // namespace splinecast::apps::mcap
