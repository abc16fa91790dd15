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
  /// Takes the lock. Throws StreamBusy if another process still holds it after 50 ms (an `rm` holds
  /// it only briefly) or has locked the region; the message names that process if the region's
  /// header can be read. Throws BadRegion if the lock file is not a private file of this
  /// user; root accepts one of any user.
  OwnerLock(std::string_view stream, RegionKind kind);

  /// Unlinks the lock file while the lock is held. Does nothing in a forked child, which does not
  /// hold the lock.
  void remove_file() noexcept;

  /// Unlinks the lock file, like remove_file(), if it is of no use: if there is no region, or if
  /// this lock created the file but its holder did not get the region, which another user created.
  void remove_unused_file() noexcept;

  /// Call this when the holder has its region: from then on the lock file remains as long as the
  /// region.
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

/// Whether the owner of a region of this kind lives. Queries the owner's lock file if this process
/// may open it, so that locks of other processes on the region cannot hide an owner. Otherwise
/// queries the region, see region_owner_lives(). System calls. Throws BadRequest for an invalid
/// name, OutOfResources if no file descriptor is left to find out.
[[nodiscard]] bool owner_lives(std::string_view stream, RegionKind kind);

/// The write lock that an owner puts on the region itself, if it can. Readers, which cannot open
/// the lock file, query it to find out whether the owner lives. A reader that already holds a read
/// lock on the region prevents this write lock.
class RegionLock {
 public:
  /// `descriptor` is that of an open region, which owns it.
  explicit RegionLock(int descriptor) noexcept : descriptor_(descriptor) { (void)hold(); }

  /// Tries to take the lock if it is not held yet. Returns whether it is held now. One system call,
  /// or none if it was held.
  bool hold() noexcept;

 private:
  int descriptor_;
  bool is_held_ = false;
};

/// Whether another open file description holds an owner's write lock on this file.
[[nodiscard]] bool is_region_locked(int descriptor) noexcept;

/// Whether the owner of an open region lives, by its write lock on the region. If the region has
/// only a read lock, by which another process prevents the write lock, decides by the process that
/// the header names: it must live and have existed since it became the owner.
[[nodiscard]] bool region_owner_lives(int descriptor) noexcept;

}  // namespace splinecast::ipc
