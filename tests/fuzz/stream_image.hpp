#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "ipc/memory/word.hpp"

/// The input of a fuzzer: the two regions of a stream as bytes, the region of a commander if the
/// stream is a time law, and a script of actions on them. A seed is a stream that real roles have
/// made; a mutation changes words of it.
namespace splinecast::fuzz {

struct StreamImage {
  std::vector<ipc::Word> ring;       ///< the waypoints region, in words
  std::vector<ipc::Word> board;      ///< the spline region
  std::vector<ipc::Word> commander;  ///< of a time law; else empty
  std::vector<std::uint8_t> script;  ///< see region_targets.hpp
};

/// The time namespace of a live stream in an image. A target writes the real one before it uses the
/// image.
inline constexpr ipc::Word kHere = 1;

/// Largest region that an image holds, in words: 4 MiB, more than the board of a time law.
inline constexpr std::size_t kMaxWords = std::size_t{1} << 19U;

/// Reads an image from the bytes of a file; any bytes are a valid image. The format: sizes of
/// script, ring, board and commander (32 bits each); the script; then ranges of words that are not
/// 0, each with its offset in the concatenation of the regions and its length (32 bits each).
[[nodiscard]] StreamImage decode(std::span<const std::uint8_t> bytes);

/// The bytes that `decode` reads as this image.
[[nodiscard]] std::vector<std::uint8_t> encode(const StreamImage& image);

/// Changes random bytes of the script or random words of the regions. First chooses a part of a
/// region: header, control block, summary, ring of changes, packed times, one part of a knot's
/// slot, a table of commanders, the body, or the whole region. The new values are likely to be
/// invalid. A tag gets another revision, form or note. The same state of `random` gives the same
/// changes.
void mutate(StreamImage& image, std::mt19937_64& random);

}  // namespace splinecast::fuzz
