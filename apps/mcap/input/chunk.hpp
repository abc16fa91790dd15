#pragma once

#include "apps/mcap/format/parsed.hpp"
#include "apps/mcap/input/decompressor.hpp"

namespace splinecast::apps::mcap {

/// The largest number of uncompressed bytes that a chunk with `compressed` bytes may have: 16 MiB
/// and 1024 times as many as compressed, at most 1 GiB.
[[nodiscard]] std::uint64_t most_uncompressed(std::uint64_t compressed) noexcept;

/// The uncompressed records of a chunk: views into the file or into the memory of `decompressor`,
/// valid until its next use. Throws InputError if the chunk is too large, cannot be decompressed,
/// or has another checksum.
[[nodiscard]] Source open_chunk(const Source& file, const Record& record, const ChunkFields& chunk,
                                Decompressor& decompressor);

}  // namespace splinecast::apps::mcap
