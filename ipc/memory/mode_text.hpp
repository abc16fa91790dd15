#pragma once

#include <sys/types.h>

#include <string>

namespace splinecast::ipc {

/// Permission bits in octal: `0640`.
[[nodiscard]] inline std::string mode_text(mode_t mode) {
  std::string text;
  for (const unsigned shift : {9U, 6U, 3U, 0U}) {
    text += static_cast<char>('0' + (mode >> shift & 7U));
  }
  return text;
}

}  // namespace splinecast::ipc
