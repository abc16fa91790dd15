#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "apps/mcap/format/compression.hpp"

namespace splinecast::apps::mcap {

/// Compresses the records of chunks. Reuses its memory.
class Compressor {
 public:
  /// Throws Failure if this program was built without the libraries for MCAP.
  explicit Compressor(Compression compression);
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;
  ~Compressor();

  /// A frame of zstd or LZ4, or the bytes themselves. Valid until the next call. Throws Failure if
  /// there is not enough memory.
  [[nodiscard]] std::span<const std::byte> compress(std::span<const std::byte> bytes);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace splinecast::apps::mcap
