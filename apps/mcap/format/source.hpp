#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace splinecast::apps::mcap {

/// A sequence of records that is read, for messages: a file, or the uncompressed records of a
/// chunk. Cheap to copy; valid as long as the name and the bytes.
struct Source {
  std::string_view name;  ///< of the file, safe to print
  std::span<const std::byte> bytes;
  std::optional<std::uint64_t> chunk{};  ///< offset of the chunk in the file

  /// Throws InputError: `file: byte 12: …`, or `file: chunk at byte 12, byte 3 of its records: …`.
  [[noreturn]] void refuse(std::uint64_t offset, std::string_view what) const;
};

}  // namespace splinecast::apps::mcap
