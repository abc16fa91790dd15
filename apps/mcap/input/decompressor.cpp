#include "apps/mcap/input/decompressor.hpp"

#include <lz4frame.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <cstdlib>
#include <new>

namespace splinecast::apps::mcap {
namespace {

constexpr const char* kTooLong = "the content is longer than the chunk says";

/// The memory of a first attempt for a content that is said to have `size` bytes.
std::size_t first_capacity(std::size_t compressed, std::size_t size) {
  constexpr std::size_t kLeast = 65536;
  constexpr std::size_t kUsualRatio = 64;
  return std::min(size, std::max(kLeast, kUsualRatio * compressed));
}

std::size_t next_capacity(std::size_t capacity, std::size_t size) {
  return std::min(size, 4 * capacity);
}

}  // namespace

struct Decompressor::State {
  struct Free {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
    void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
    void operator()(std::byte* bytes) const { std::free(bytes); }  // NOLINT(*-no-malloc)
  };

  std::unique_ptr<ZSTD_DCtx, Free> zstd{};
  std::unique_ptr<LZ4F_dctx, Free> lz4{};
  std::unique_ptr<std::byte, Free> memory{};
  std::size_t capacity = 0;

  /// The memory with at least `size` bytes. Keeps its content. realloc() moves large memory without
  /// a copy.
  std::byte* reserve(std::size_t size) {
    if (size > capacity) {
      auto* const grown = std::realloc(memory.get(), size);  // NOLINT(*-no-malloc)
      if (grown == nullptr) throw std::bad_alloc();
      static_cast<void>(memory.release());
      memory.reset(static_cast<std::byte*>(grown));
      capacity = size;
    }
    return memory.get();
  }
};

Decompressor::Decompressor() : state_(std::make_unique<State>()) {}
Decompressor::~Decompressor() = default;

Decompressor::Result Decompressor::decompress(Compression compression,
                                              std::span<const std::byte> frames, std::size_t size) {
  Result result{frames, ""};
  if (compression == Compression::zstd) result = decompress_zstd(frames, size);
  if (compression == Compression::lz4) result = decompress_lz4(frames, size);
  if (result.error.empty() && result.bytes.size() != size) {
    result.error = "the content is shorter than the chunk says";
    if (result.bytes.size() > size) result.error = kTooLong;
  }
  return result;
}

Decompressor::Result Decompressor::decompress_zstd(std::span<const std::byte> frames,
                                                   std::size_t size) {
  if (!state_->zstd) state_->zstd.reset(ZSTD_createDCtx());
  if (!state_->zstd) throw std::bad_alloc();
  for (std::size_t capacity = first_capacity(frames.size(), size);;
       capacity = next_capacity(capacity, size)) {
    std::byte* const out = state_->reserve(std::max<std::size_t>(capacity, 1));
    const std::size_t written =
        ZSTD_decompressDCtx(state_->zstd.get(), out, capacity, frames.data(), frames.size());
    if (ZSTD_isError(written) == 0) return {{out, written}, ""};
    if (ZSTD_getErrorCode(written) != ZSTD_error_dstSize_tooSmall) {
      return {{}, ZSTD_getErrorName(written)};
    }
    if (capacity == size) return {{}, kTooLong};
  }
}

Decompressor::Result Decompressor::decompress_lz4(std::span<const std::byte> frames,
                                                  std::size_t size) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) {
    throw std::bad_alloc();
  }
  state_->lz4.reset(context);
  std::size_t capacity = first_capacity(frames.size(), size);
  std::byte* out = state_->reserve(std::max<std::size_t>(capacity, 1));
  std::size_t written = 0;
  for (std::size_t wanted = 1; wanted != 0 || !frames.empty();) {
    std::size_t room = capacity - written;
    std::size_t taken = frames.size();
    wanted = LZ4F_decompress(context, out + written, &room, frames.data(), &taken, nullptr);
    if (LZ4F_isError(wanted) != 0) return {{}, LZ4F_getErrorName(wanted)};
    written += room;
    frames = frames.subspan(taken);
    if (room != 0 || taken != 0) continue;
    if (frames.empty() && written < capacity) return {{}, "the frame is cut off"};
    if (capacity == size) return {{}, frames.empty() ? "the frame is cut off" : kTooLong};
    capacity = next_capacity(capacity, size);
    out = state_->reserve(capacity);
  }
  return {{out, written}, ""};
}

}  // namespace splinecast::apps::mcap
