#pragma once

#include <string>
#include <vector>

#include "tests/fuzz/stream_image.hpp"

namespace splinecast::fuzz {

struct Seed {
  std::string name;
  StreamImage image;
};

/// Streams that a real producer and a real solver have made, in all the states that a board knows:
/// running, starved, entered again, cut, finished; every family of methods and kind of dimension.
/// The same on each call and machine but for rounding of the C library.
[[nodiscard]] std::vector<Seed> make_seeds();

}  // namespace splinecast::fuzz
