#include "apps/mcap/output/compressor.hpp"

#include <lz4frame.h>
#include <zstd.h>

#include <string>
#include <vector>

#include "apps/process/exit_codes.hpp"

namespace splinecast::apps::mcap {
namespace {

/// Fast levels: a recorder must not slow down what it records. Level 1 of zstd makes files that are
/// an eighth smaller, in twice the time.
constexpr int kZstdLevel = -1;
constexpr LZ4F_preferences_t kLz4Default{};

}  // namespace

struct Compressor::State {
  struct Free {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  };

  Compression compression;
  std::unique_ptr<ZSTD_CCtx, Free> zstd{};
  std::vector<std::byte> compressed{};
};

Compressor::Compressor(Compression compression) : state_(new State{compression}) {
  if (compression == Compression::zstd) state_->zstd.reset(ZSTD_createCCtx());
}

Compressor::~Compressor() = default;

std::span<const std::byte> Compressor::compress(std::span<const std::byte> bytes) {
  if (state_->compression == Compression::none) return bytes;
  auto& out = state_->compressed;
  const bool is_zstd = state_->compression == Compression::zstd;
  const std::size_t most = is_zstd ? ZSTD_compressBound(bytes.size())
                                   : LZ4F_compressFrameBound(bytes.size(), &kLz4Default);
  if (out.size() < most) out.resize(most);
  const std::size_t size =
      is_zstd ? ZSTD_compressCCtx(state_->zstd.get(), out.data(), out.size(), bytes.data(),
                                  bytes.size(), kZstdLevel)
              : LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), nullptr);
  if (is_zstd ? ZSTD_isError(size) != 0 : LZ4F_isError(size) != 0) {
    throw Failure(std::string("a chunk cannot be compressed: ") +
                  (is_zstd ? ZSTD_getErrorName(size) : LZ4F_getErrorName(size)));
  }
  return std::span(out).first(size);
}

}  // namespace splinecast::apps::mcap
