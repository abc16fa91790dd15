#pragma once

#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// Detects by the modification time of the shared memory folder whether files may have been created
/// or removed there. While nothing changes: one system call, no descriptor, no directory to read.
class FolderWatch {
 public:
  /// Whether files may have been created or removed since the last call; true at the first call.
  [[nodiscard]] bool has_changed() noexcept;

 private:
  Time modified_ = Time::min();
  bool was_fresh_ = false;  ///< a later change may get the same modification time
};

}  // namespace splinecast::ipc
