#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "ipc/memory/word.hpp"

/// What a fuzzer feeds: the two regions of a stream as bytes, and a script of what is done with
/// them. A seed is a stream that real roles have made; a mutation of it changes words.
namespace splinecast::fuzz {

struct StreamImage {
  std::vector<ipc::Word> ring;       ///< the waypoints region, in words
  std::vector<ipc::Word> board;      ///< the spline region
  std::vector<std::uint8_t> script;  ///< see region_targets.hpp
};

/// Time namespace of a live stream in an image: that of whoever tries it.
inline constexpr ipc::Word kHere = 1;

/// Largest region that an image holds, in words: 256 KiB.
inline constexpr std::size_t kMaxWords = std::size_t{1} << 15U;

/// Reads an image from the bytes of a file; any bytes are some image. Of the regions a file holds
/// the stretches that are not 0: sizes of script, ring and board (32 bits each), the script, then
/// stretches of words, each with where it begins in ring and board laid end to end, and its length
/// (32 bits each).
[[nodiscard]] StreamImage decode(std::span<const std::uint8_t> bytes);

/// The bytes of which `decode` makes this image.
[[nodiscard]] std::vector<std::uint8_t> encode(const StreamImage& image);

/// Changes a few words of the regions, or bytes of the script, at random: of the header, control
/// block, head, ring of changes, packed times, a knot's cells, nodes and rows and what is beside,
/// items or anywhere, to a number that is likely to be of interest there; of tags the revision, the
/// form, the other bits. Equal generators change the same.
void mutate(StreamImage& image, std::mt19937_64& random);

}  // namespace splinecast::fuzz
