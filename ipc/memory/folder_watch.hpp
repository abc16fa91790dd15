#pragma once

#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Detects whether files may have been created or removed in the folder of shared memory, by the
/// folder's modification time: one system call, no descriptor, no directory to read while nothing
/// changes.
class FolderWatch {
 public:
  /// Whether this may have happened since the last call; true at the first call.
  [[nodiscard]] bool has_changed() noexcept;

 private:
  Time modified_ = Time::min();
  bool was_fresh_ = false;  ///< later changes may have the same modification time
};

}  // namespace splinecast::ipc
