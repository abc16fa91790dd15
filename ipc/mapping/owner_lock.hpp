#pragma once

#include <sys/types.h>

#include <string>
#include <string_view>

#include "ipc/memory/descriptor.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::ipc {

/// The lock that makes a process the one writer of a region: an open file description lock on
/// `<region>.lock`, a file that is never mapped. The kernel releases it when the process ends, for
/// any reason: there are no stale locks, PID files or timeouts.
class OwnerLock {
 public:
  /// Takes the lock, or throws StreamBusy within 50 ms (an `rm` holds it briefly), naming the
  /// owner's process if the region does; BadRegion if the lock file is not this user's.
  OwnerLock(std::string_view stream, RegionKind kind);

  /// Unlinks the lock file while the lock is held. Does nothing in a forked child, which does not
  /// hold the lock.
  void remove_file() noexcept;

  /// The same if the file is litter: if it has no region, or if this lock created the file and its
  /// holder could not use the region, which another user created.
  void remove_litter() noexcept;

  /// Called when the holder has its region: the lock file then remains as long as the region.
  void keep_file() noexcept { made_file_ = false; }

 private:
  std::string stream_;
  RegionKind kind_;
  std::string path_;
  pid_t holder_;
  bool made_file_ = false;
  OwnedDescriptor descriptor_;
};

/// Whether a process of this user holds the owner's lock, even if it has no region yet. System
/// calls. Throws OutOfResources if no file descriptor is left to find out.
[[nodiscard]] bool is_owned(std::string_view stream, RegionKind kind);

/// Whether the owner of a region of this kind lives. Queries the owner's lock if this process may
/// open its file, so that locks of other processes on the region cannot hide an owner; else the
/// region, see region_owner_lives(). System calls. Throws BadRequest for an invalid name,
/// OutOfResources if no file descriptor is left to find out.
[[nodiscard]] bool owner_lives(std::string_view stream, RegionKind kind);

/// The write lock that an owner puts on the region itself, best effort. Readers, which cannot open
/// the lock file, query it to find out whether the owner lives. A reader that already holds a read
/// lock prevents it.
class RegionLock {
 public:
  /// `descriptor` belongs to an open region, which keeps it.
  explicit RegionLock(int descriptor) noexcept : descriptor_(descriptor) { (void)hold(); }

  /// Tries to take the lock unless it is held. Returns whether it is held. One system call if it
  /// was not.
  bool hold() noexcept;

 private:
  int descriptor_;
  bool is_held_ = false;
};

/// Whether another open file description holds an owner's write lock on this file.
[[nodiscard]] bool is_region_locked(int descriptor) noexcept;

/// Whether the owner of an open region lives, by its write lock. If a read lock of another process
/// prevents that lock, by the process that the header names: it must exist and have existed since
/// it became the owner.
[[nodiscard]] bool region_owner_lives(int descriptor) noexcept;

}  // namespace splinecast::ipc
