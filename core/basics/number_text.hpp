#pragma once

#include <array>
#include <charconv>
#include <string>

namespace splinecast::core {

/// A number in the shortest form that reads back exactly. std::to_string loses small numbers and
/// writes a hundred digits for large ones.
inline std::string number_text(double value) {
  std::array<char, 32> buffer{};
  return {buffer.begin(), std::to_chars(buffer.begin(), buffer.end(), value).ptr};
}

}  // namespace splinecast::core
