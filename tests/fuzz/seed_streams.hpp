#pragma once

#include <string>
#include <vector>

#include "tests/fuzz/stream_image.hpp"

namespace splinecast::fuzz {

struct Seed {
  std::string name;
  StreamImage image;
};

/// Streams of a real producer and a real solver, in all states of a board: running, starved,
/// entered again, cut, finished; with every family of methods and every kind of dimension; and a
/// time law. The same on each call and machine, except for rounding of the C library and for the
/// origin of the law, which is the time of its making.
[[nodiscard]] std::vector<Seed> make_seeds();

}  // namespace splinecast::fuzz
