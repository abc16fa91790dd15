#pragma once

#include <sys/types.h>

#include <string>
#include <string_view>

#include "ipc/memory/descriptor.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::ipc {

/// What makes a process the one writer of a region: an open-file-description lock on
/// `<region>.lock`, a file that is never mapped. The kernel releases it with its process, however
/// that ends: there are no stale locks, PID files or time-outs.
class OwnerLock {
 public:
  /// Takes the lock or throws StreamBusy within 50 ms (a passing `rm` holds it for an instant),
  /// naming the owner's process where its region does; BadRegion if the lock file is not this
  /// user's.
  OwnerLock(std::string_view stream, RegionKind kind);

  /// Unlinks the lock file, while the lock is still held. Does nothing in a forked child, which
  /// does not hold it.
  void remove_file() noexcept;

  /// The same if the file is litter: if no region stands beside it, or if this lock made the file
  /// and its holder was refused the region, which somebody else put there.
  void remove_litter() noexcept;

  /// Says that the holder has got its region: the lock file stays with that.
  void keep_file() noexcept { made_file_ = false; }

 private:
  std::string stream_;
  RegionKind kind_;
  std::string path_;
  pid_t holder_;
  bool made_file_ = false;
  OwnedDescriptor descriptor_;
};

/// Whether a process of this user holds the owner's lock, also one that has no region yet. System
/// calls. Throws OutOfResources where no descriptor is left to look with.
[[nodiscard]] bool is_owned(std::string_view stream, RegionKind kind);

/// Whether the process lives that owns a region of this kind: by the owner's lock, where this
/// process may open its file, so that nobody else's locks on the region can hide an owner; else by
/// the region, see region_owner_lives(). System calls. Throws BadRequest for an invalid name,
/// OutOfResources where no descriptor is left to look with.
[[nodiscard]] bool owner_lives(std::string_view stream, RegionKind kind);

/// The write lock that an owner puts on its region itself, best effort: readers, who cannot open
/// the lock file, query it to learn whether the owner lives. A reader that holds a read lock when
/// the owner comes prevents it.
class RegionLock {
 public:
  /// Of an open region, which keeps the descriptor.
  explicit RegionLock(int descriptor) noexcept : descriptor_(descriptor) { (void)hold(); }

  /// Tries again unless the lock is held. Returns whether it is. A system call if it was not.
  bool hold() noexcept;

 private:
  int descriptor_;
  bool is_held_ = false;
};

/// Whether another open file holds an owner's write lock on this one.
[[nodiscard]] bool is_region_locked(int descriptor) noexcept;

/// Whether the owner of an open region lives, by its write lock. Where a read lock of another
/// process prevents that one, by the process that the header names, which must exist and have
/// existed since it became the owner.
[[nodiscard]] bool region_owner_lives(int descriptor) noexcept;

}  // namespace splinecast::ipc
