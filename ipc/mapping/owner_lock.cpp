#include "ipc/mapping/owner_lock.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <optional>
#include <thread>

#include "ipc/layout/header.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/mode_text.hpp"
#include "ipc/memory/process_life.hpp"
#include "ipc/memory/system_failure.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

/// Maximum number of tries to take a lock that another process holds without a lock on the region:
/// that process may be an `rm`, which soon releases it.
constexpr int kLockTries = 10;
constexpr std::chrono::milliseconds kLockPoll{5};

/// Maximum number of tries to open a lock file that other processes remove repeatedly.
constexpr int kOpenTries = 100;

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

/// Opens the lock file or, if there is none, creates it; then `made_file` is true. The first try is
/// without O_CREAT, because the kernel may refuse that flag for other users' files in sticky
/// directories (fs.protected_regular).
OwnedDescriptor open_lock_file(const std::string& path, bool& made_file) {
  constexpr int kFlags = O_RDWR | O_NOFOLLOW | O_NONBLOCK;
  for (int tries = 1;; ++tries) {
    made_file = false;
    OwnedDescriptor existing = OwnedDescriptor::open(path, kFlags);
    if (existing.get() >= 0 || errno != ENOENT || tries == kOpenTries) return existing;
    OwnedDescriptor made =
        OwnedDescriptor::open(path, kFlags | O_CREAT | O_EXCL, S_IRUSR | S_IWUSR);
    made_file = made.get() >= 0;
    if (made_file || errno != EEXIST) return made;
  }
}

/// Whether the path still names the file that was opened.
bool is_named(int descriptor, const std::string& path) noexcept {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && lstat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

void require_own_file(int descriptor, const std::string& path) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) throw_failure("cannot stat lock " + path, errno);
  const bool is_trusted = status.st_uid == geteuid() || geteuid() == 0;
  if (!S_ISREG(status.st_mode) || !is_trusted || (status.st_mode & 077) != 0) {
    throw BadRegion("lock " + path + " is not a private file of this user (owner " +
                    std::to_string(status.st_uid) + ", mode " + mode_text(status.st_mode) + ")");
  }
}

/// Opens a file to query its locks. Returns nullopt if the file does not exist or this process may
/// not open it. Throws OutOfResources if resources are short.
std::optional<OwnedDescriptor> open_to_query(const std::string& path) {
  OwnedDescriptor opened = OwnedDescriptor::open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK);
  if (opened.get() >= 0) return opened;
  if (is_shortage(errno)) throw_failure("cannot query the lock of " + path, errno);
  return std::nullopt;
}

/// Whether OwnerLock accepts this file: a regular file of this user or, if this process is root, of
/// any user.
bool is_lock_file(int descriptor) noexcept {
  struct stat status {};
  return fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) &&
         (status.st_uid == geteuid() || geteuid() == 0);
}

/// Whether the owner's lock is held; nullopt if the lock file does not exist, is not valid, or this
/// process may not open it.
std::optional<bool> is_lock_held(std::string_view stream, RegionKind kind) {
  const auto file = open_to_query(lock_path(stream, kind));
  if (!file || !is_lock_file(file->get())) return std::nullopt;
  return is_region_locked(file->get());
}

bool is_region_file_locked(std::string_view stream, RegionKind kind) {
  const auto file = open_to_query(region_path(stream, kind));
  return file && is_region_locked(file->get());
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
    descriptor_ = open_lock_file(path_, made_file_);
    if (descriptor_.get() < 0) {
      if (errno == EACCES) throw BadRegion("lock " + path_ + " belongs to another user");
      throw_failure("cannot open lock " + path_, errno);
    }
    require_own_file(descriptor_.get(), path_);
    if (!try_lock(descriptor_.get())) {
      if (attempt < kLockTries && !is_region_file_locked(stream, kind)) {
        std::this_thread::sleep_for(kLockPoll);
        continue;
      }
      throw StreamBusy("stream '" + std::string(stream) + "' has a living " +
                       std::string(owner_role(kind)) + owner_process(stream, kind));
    }
    // A lock on a file that was unlinked after it was opened protects nothing.
    if (is_named(descriptor_.get(), path_)) return;
    if (attempt == kOpenTries) throw BadRegion("lock " + path_ + " is removed repeatedly");
  }
}

void OwnerLock::remove_file() noexcept {
  if (getpid() == holder_) unlink(path_.c_str());
}

void OwnerLock::remove_unused_file() noexcept {
  if (made_file_ || !region_exists(stream_, kind_)) remove_file();
}

bool is_owned(std::string_view stream, RegionKind kind) {
  return is_lock_held(stream, kind).value_or(false);
}

bool owner_lives(std::string_view stream, RegionKind kind) {
  if (const auto held = is_lock_held(stream, kind)) return *held;
  const auto region = open_to_query(region_path(stream, kind));
  return region && region_owner_lives(region->get());
}

bool RegionLock::hold() noexcept {
  is_held_ = is_held_ || try_lock(descriptor_);
  return is_held_;
}

bool is_region_locked(int descriptor) noexcept {
  // The query for a read lock finds only write locks: other processes' read locks do not count.
  struct flock lock = whole_file(F_RDLCK);
  return fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

bool region_owner_lives(int descriptor) noexcept {
  // The query for a write lock finds both read and write locks.
  struct flock lock = whole_file(F_WRLCK);
  if (fcntl(descriptor, F_OFD_GETLK, &lock) != 0 || lock.l_type == F_UNLCK) return false;
  if (lock.l_type == F_WRLCK) return true;
  std::array<Word, kHeaderWords> words{};
  if (pread(descriptor, words.data(), sizeof words, 0) != sizeof words) return false;
  const RegionHeader header = decode_header(words);
  return process_lives(header.owner_pid, Time(header.owner_since));
}

}  // namespace splinecast::ipc
