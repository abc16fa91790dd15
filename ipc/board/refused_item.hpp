#pragma once

#include "ipc/memory/word.hpp"
#include "splinecast/status.hpp"

namespace splinecast::ipc {

/// An item that the solver refused.
struct RefusedItem {
  Word item = 0;
  Refusal reason{};
};

}  // namespace splinecast::ipc
