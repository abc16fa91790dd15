#include "apps/mcap/input/chunk_search.hpp"

#include <cstring>
#include <string_view>

#include "apps/mcap/format/compression.hpp"
#include "apps/mcap/format/fields.hpp"

namespace splinecast::apps::mcap {
namespace {

/// Offsets in the content of a chunk record.
constexpr std::size_t kCompressionSize = 28;
constexpr std::size_t kCompression = 32;
/// Bytes of the content without the compression and the records.
constexpr std::size_t kFixed = 40;

/// Whether bytes begin with a whole chunk record.
bool begins_with_chunk(std::span<const std::byte> bytes) {
  if (bytes.size() < kRecordHeader + kFixed) return false;
  const auto size = load<std::uint64_t>(bytes.data() + 1);
  if (size < kFixed || size > bytes.size() - kRecordHeader) return false;
  const auto content = bytes.subspan(kRecordHeader, size);
  const auto word_size = load<std::uint32_t>(content.data() + kCompressionSize);
  if (word_size > size - kFixed) return false;
  const std::string_view word(
      reinterpret_cast<const char*>(content.data()) + kCompression,  // NOLINT(*-reinterpret-cast)
      word_size);
  const auto records = load<std::uint64_t>(content.data() + kCompression + word_size);
  return compression_of(word).has_value() && records == size - kFixed - word_size;
}

}  // namespace

std::optional<std::uint64_t> find_chunk(std::span<const std::byte> file, std::uint64_t begin,
                                        std::uint64_t end) {
  const auto part = file.first(end);
  while (begin < end) {
    const void* const found =
        std::memchr(part.data() + begin, static_cast<int>(Opcode::chunk), end - begin);
    if (found == nullptr) return std::nullopt;
    begin = static_cast<std::uint64_t>(static_cast<const std::byte*>(found) - part.data());
    if (begins_with_chunk(part.subspan(begin))) return begin;
    ++begin;
  }
  return std::nullopt;
}

}  // namespace splinecast::apps::mcap
