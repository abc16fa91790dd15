#pragma once

#include <cstdint>

#include "ipc/memory/word.hpp"
#include "splinecast/status.hpp"

namespace splinecast::ipc {

/// An item that the solver refused.
struct RefusalRecord {
  Word item = 0;
  Refusal reason{};
  std::uint8_t slot = 0;  ///< of the stopper, if it was refused as `stopped`
};

}  // namespace splinecast::ipc
