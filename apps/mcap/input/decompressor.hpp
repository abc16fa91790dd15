#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "apps/mcap/format/compression.hpp"

namespace splinecast::apps::mcap {

/// Decompresses the records of chunks. Reuses its memory, which grows to the size of the largest
/// chunk.
class Decompressor {
 public:
  /// Throws Failure if this program was built without the libraries for MCAP.
  Decompressor();
  Decompressor(const Decompressor&) = delete;
  Decompressor& operator=(const Decompressor&) = delete;
  ~Decompressor();

  /// The outcome: bytes, valid until the next call, or a reason why there are none.
  struct Result {
    std::span<const std::byte> bytes;
    std::string error;
  };
  /// Decompresses frames whose content has `size` bytes. `size` need not be true: the memory grows
  /// with the content. Takes time in proportion to the content.
  [[nodiscard]] Result decompress(Compression compression, std::span<const std::byte> frames,
                                  std::size_t size);

 private:
  struct State;
  [[nodiscard]] Result decompress_zstd(std::span<const std::byte> frames, std::size_t size);
  [[nodiscard]] Result decompress_lz4(std::span<const std::byte> frames, std::size_t size);

  std::unique_ptr<State> state_;
};

}  // namespace splinecast::apps::mcap
