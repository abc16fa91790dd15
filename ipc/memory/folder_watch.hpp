#pragma once

#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Tells whether files have come or gone in the folder of shared memory, by the folder's time of
/// modification: one system call, no descriptor, and nothing to read where nothing happens.
class FolderWatch {
 public:
  /// Whether they may have since the last call; true at the first.
  [[nodiscard]] bool has_changed() noexcept;

 private:
  Time modified_ = Time::min();
  bool was_fresh_ = false;  ///< what came after the last look may bear the same stamp
};

}  // namespace splinecast::ipc
