#include "apps/mcap/input/chunk.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/mcap/format/checksum.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps::mcap {
namespace {

constexpr std::uint64_t kMostChunk = std::uint64_t{1} << 30U;
constexpr std::uint64_t kAlways = std::uint64_t{16} << 20U;
constexpr std::uint64_t kMostRatio = 1024;

}  // namespace

std::uint64_t most_uncompressed(std::uint64_t compressed) noexcept {
  return std::min(kMostChunk, kAlways + kMostRatio * std::min(compressed, kMostChunk));
}

Source open_chunk(const Source& file, const Record& record, const ChunkFields& chunk,
                  Decompressor& decompressor) {
  const auto compression = compression_of(chunk.compression);
  if (!compression) {
    file.refuse(record.offset, fmt::format("a chunk has the unknown compression '{}'",
                                           ipc::printable(chunk.compression.substr(0, 32))));
  }
  const std::uint64_t most = most_uncompressed(chunk.records.size());
  if (*compression != Compression::none && chunk.uncompressed_size > most) {
    file.refuse(record.offset,
                fmt::format("a chunk of {} bytes has {} bytes uncompressed, more than {}",
                            chunk.records.size(), chunk.uncompressed_size, most));
  }
  const auto result = decompressor.decompress(*compression, chunk.records, chunk.uncompressed_size);
  if (!result.error.empty()) {
    file.refuse(
        record.offset,
        fmt::format("a chunk cannot be decompressed ({}): {}",
                    compression == Compression::none ? "none" : chunk.compression, result.error));
  }
  const std::uint32_t crc = chunk.uncompressed_crc == 0 ? 0 : crc32_of(result.bytes);
  if (crc != chunk.uncompressed_crc) {
    file.refuse(record.offset, fmt::format("a chunk has the CRC {:#010x}, but {:#010x} is recorded",
                                           crc, chunk.uncompressed_crc));
  }
  return {file.name, result.bytes, record.offset};
}

}  // namespace splinecast::apps::mcap
