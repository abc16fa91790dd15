#include <string>

#include "apps/mcap/format/checksum.hpp"
#include "apps/mcap/input/decompressor.hpp"
#include "apps/mcap/output/compressor.hpp"
#include "apps/process/exit_codes.hpp"

// Replaces the files that need zlib, LZ4 or zstd, if one of these is missing.

namespace splinecast::apps::mcap {

void require_mcap() {
  throw Failure(
      "this program was built without MCAP (it needs zlib, LZ4 and zstd; Debian: zlib1g-dev "
      "liblz4-dev libzstd-dev)");
}

std::uint32_t crc32_of(std::span<const std::byte> /*bytes*/, std::uint32_t /*before*/) {
  require_mcap();
  return 0;
}

struct Compressor::State {};
Compressor::Compressor(Compression /*compression*/) { require_mcap(); }
Compressor::~Compressor() = default;
std::span<const std::byte> Compressor::compress(std::span<const std::byte> bytes) { return bytes; }

struct Decompressor::State {};
Decompressor::Decompressor() { require_mcap(); }
Decompressor::~Decompressor() = default;
Decompressor::Result Decompressor::decompress(Compression /*compression*/,
                                              std::span<const std::byte> /*frames*/,
                                              std::size_t /*size*/) {
  return {};
}

}  // namespace splinecast::apps::mcap
