#pragma once

#include <string>
#include <string_view>

#include "splinecast/ipc/names.hpp"
#include "splinecast/ipc/owned_descriptor.hpp"

namespace splinecast::ipc {

/// What makes a process the one writer of a region: an open-file-description lock on
/// `<region>.lock`, a file that is never mapped. The kernel releases it with its process, however
/// that ends: there are no stale locks, PID files or time-outs.
class OwnerLock {
 public:
  /// Takes the lock or throws StreamBusy at once, naming the owner's process where its region does;
  /// BadRegion if the lock file is not this user's.
  OwnerLock(std::string_view stream, RegionKind kind);

  /// Unlinks the lock file, while the lock is still held.
  void remove_file() noexcept;

 private:
  std::string path_;
  OwnedDescriptor descriptor_;
};

/// Puts a write lock on a region itself, best effort: readers, who cannot open the lock file,
/// query it to learn whether the owner lives.
bool try_lock_region(int descriptor) noexcept;

/// Whether another open file holds that write lock.
[[nodiscard]] bool is_region_locked(int descriptor) noexcept;

}  // namespace splinecast::ipc
