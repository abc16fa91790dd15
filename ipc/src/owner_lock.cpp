#include "splinecast/ipc/owner_lock.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <optional>
#include <system_error>
#include <thread>

#include "splinecast/ipc/errors.hpp"
#include "splinecast/ipc/layout.hpp"
#include "splinecast/ipc/mode_text.hpp"
#include "splinecast/ipc/region.hpp"

namespace splinecast::ipc {
namespace {

/// How long a lock is tried for whose holder has no region locked: it may be an `rm` passing by.
constexpr int kLockTries = 10;
constexpr std::chrono::milliseconds kLockPoll{5};

struct flock whole_file(short type) noexcept {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  return lock;
}

bool try_lock(int descriptor) noexcept {
  struct flock lock = whole_file(F_WRLCK);
  return fcntl(descriptor, F_OFD_SETLK, &lock) == 0;
}

/// Opens the lock file, making it if there is none; says which in `made_file`. Without O_CREAT
/// first, because kernels refuse that flag on other users' files in sticky folders.
int open_lock_file(const std::string& path, bool& made_file) {
  constexpr int kFlags = O_RDWR | O_CLOEXEC | O_NOFOLLOW;
  for (;;) {
    made_file = false;
    const int existing = open(path.c_str(), kFlags);
    if (existing >= 0 || errno != ENOENT) return existing;
    const int made = open(path.c_str(), kFlags | O_CREAT | O_EXCL, S_IRUSR | S_IWUSR);
    made_file = made >= 0;
    if (made >= 0 || errno != EEXIST) return made;
  }
}

/// Whether the name still leads to the file that was opened.
bool is_named(int descriptor, const std::string& path) noexcept {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && lstat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

void require_own_file(int descriptor, const std::string& path) {
  struct stat status {};
  fstat(descriptor, &status);
  if (!S_ISREG(status.st_mode) || status.st_uid != geteuid() || (status.st_mode & 077) != 0) {
    throw BadRegion("lock " + path + " is not a private file of this user (owner " +
                    std::to_string(status.st_uid) + ", mode " + mode_text(status.st_mode) + ")");
  }
}

/// Whether another open file holds the write lock of an owner on the file; nothing if this process
/// may not open it.
std::optional<bool> is_file_locked(const std::string& path) {
  const int opened = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (opened < 0) return std::nullopt;
  const bool locked = is_region_locked(opened);
  close(opened);
  return locked;
}

bool is_region_file_locked(std::string_view stream, RegionKind kind) {
  return is_file_locked(region_path(stream, kind)).value_or(false);
}

/// " (process N)", if the owner's region can be read.
std::string owner_process(std::string_view stream, RegionKind kind) {
  try {
    const Region region = Region::open(stream, kind, false);
    return " (process " + std::to_string(copy_header(region.bytes()).owner_pid) + ")";
  } catch (const StreamError&) {
    return {};
  }
}

}  // namespace

OwnerLock::OwnerLock(std::string_view stream, RegionKind kind)
    : stream_(stream), kind_(kind), path_(lock_path(stream, kind)), holder_(getpid()) {
  for (int attempt = 1;; ++attempt) {
    const int descriptor = open_lock_file(path_, made_file_);
    if (descriptor < 0) {
      if (errno == EACCES) throw BadRegion("lock " + path_ + " belongs to another user");
      throw BadRegion("cannot open lock " + path_ + ": " + std::generic_category().message(errno));
    }
    descriptor_ = OwnedDescriptor(descriptor);
    require_own_file(descriptor, path_);
    if (!try_lock(descriptor)) {
      if (attempt < kLockTries && !is_region_file_locked(stream, kind)) {
        std::this_thread::sleep_for(kLockPoll);
        continue;
      }
      throw StreamBusy("stream '" + std::string(stream) + "' has a living " +
                       std::string(owner_role(kind)) + owner_process(stream, kind));
    }
    // A file that was unlinked after it was opened guards nothing any more.
    if (is_named(descriptor, path_)) return;
  }
}

void OwnerLock::remove_file() noexcept {
  if (getpid() == holder_) unlink(path_.c_str());
}

void OwnerLock::remove_litter() noexcept {
  if (made_file_ || !region_exists(stream_, kind_)) remove_file();
}

bool is_owned(std::string_view stream, RegionKind kind) {
  return is_file_locked(lock_path(stream, kind)).value_or(false);
}

bool owner_lives(std::string_view stream, RegionKind kind) {
  const auto owned = is_file_locked(lock_path(stream, kind));
  return owned ? *owned : is_region_file_locked(stream, kind);
}

bool try_lock_region(int descriptor) noexcept { return try_lock(descriptor); }

bool is_region_locked(int descriptor) noexcept {
  // A read lock conflicts with the owner's write lock only, not with other readers' queries.
  struct flock lock = whole_file(F_RDLCK);
  return fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

}  // namespace splinecast::ipc
