#include "ipc/mapping/region.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <boost/interprocess/mapped_region.hpp>
#include <cerrno>
#include <system_error>
#include <utility>

#include "ipc/layout/areas.hpp"
#include "ipc/memory/descriptor.hpp"
#include "ipc/memory/mode_text.hpp"
#include "ipc/memory/separation.hpp"
#include "ipc/memory/system_failure.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

namespace bip = boost::interprocess;

std::string error_text(int error) { return std::generic_category().message(error); }

/// Passes a descriptor to boost::interprocess::mapped_region, as Boost's concept MemoryMappable
/// requires. Does not own it.
class DescriptorMapping {
 public:
  explicit DescriptorMapping(int descriptor) : descriptor_(descriptor) {}
  [[nodiscard]] bip::mapping_handle_t get_mapping_handle() const {
    return bip::ipcdetail::mapping_handle_from_file_handle(descriptor_);
  }

 private:
  int descriptor_;
};

/// Bytes free in the file system of an open file.
std::string free_bytes(int descriptor) {
  struct statvfs status {};
  fstatvfs(descriptor, &status);
  return std::to_string(status.f_bavail * status.f_frsize);
}

/// Calls `map`. Converts Boost's exceptions, which do not say what could not be mapped, to errors
/// that name `what`.
template <typename Map>
auto naming_what(const std::string& what, const Map& map) {
  try {
    return map();
  } catch (const bip::interprocess_exception& error) {
    if (error.get_native_error() != 0)
      throw_failure("cannot map " + what, error.get_native_error());
    throw BadRegion("cannot map " + what + ": " + error.what());
  }
}

/// Throws BadRegion if the file size limit of this process is below `bytes`: otherwise the kernel
/// would end the process with SIGXFSZ.
void require_file_size(std::size_t bytes) {
  struct rlimit limit {};
  if (getrlimit(RLIMIT_FSIZE, &limit) != 0 || bytes <= limit.rlim_cur) return;
  throw BadRegion("cannot reserve " + std::to_string(bytes) +
                  " bytes of shared memory: the file size limit of this process is " +
                  std::to_string(limit.rlim_cur) + " (RLIMIT_FSIZE)");
}

/// Reserves memory in pieces, because a signal cancels the reservation of the current piece. After
/// each interruption the pieces are half as long, so that the loop ends at any rate of signals.
void reserve_pages(int descriptor, std::size_t bytes) {
  constexpr int kTriesOfAPage = 1000;
  require_file_size(bytes);
  std::size_t piece = bytes;
  int tries = 0;
  for (std::size_t at = 0; at < bytes;) {
    const std::size_t size = std::min(piece, bytes - at);
    const int error = posix_fallocate(descriptor, static_cast<off_t>(at), static_cast<off_t>(size));
    if (error == 0) {
      at += size;
      tries = 0;
    } else if (error == EINTR && (size > kPage || ++tries < kTriesOfAPage)) {
      piece = std::max(size / 2, kPage);
    } else {
      throw_failure("cannot reserve " + std::to_string(bytes) + " bytes of shared memory, " +
                        free_bytes(descriptor) + " are free",
                    error);
    }
  }
}

/// Faults in all pages now, so that no sample, append or solve causes a page fault.
void populate(std::span<std::byte> bytes, bool writable, int descriptor) {
  const int advice = writable ? MADV_POPULATE_WRITE : MADV_POPULATE_READ;
  if (madvise(bytes.data(), bytes.size(), advice) == 0) return;
  if (errno != EINVAL) {
    // The file has holes, and no memory is left for them: touching one would raise SIGBUS.
    throw OutOfResources("cannot populate " + std::to_string(bytes.size()) +
                         " bytes of shared memory, " + free_bytes(descriptor) +
                         " are free: " + error_text(errno));
  }
  // Kernels before 5.14 do not know this advice.
  for (std::size_t at = 0; at < bytes.size(); at += kPage) {
    (void)load(words_at(std::span<const std::byte>(bytes), at, 1)[0], std::memory_order_relaxed);
  }
}

void require_trusted(const struct stat& status, const std::string& path, const Trust& trust) {
  if (!S_ISREG(status.st_mode)) throw BadRegion(path + " is not a regular file");
  const bool is_ours = status.st_uid == geteuid() || status.st_uid == 0 ||
                       (trust.owner && status.st_uid == *trust.owner);
  if (!is_ours) {
    throw BadRegion(path + " belongs to user " + std::to_string(status.st_uid) +
                    ", who is not trusted (--owner)");
  }
  if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
    throw BadRegion(path + " may be written by others than its owner (mode " +
                    mode_text(status.st_mode) + ")");
  }
}

/// Opens a region's file. Callers check the descriptor, not the name, because the name may refer to
/// another file at each call. O_NONBLOCK: open does not wait for the other end of a FIFO or for a
/// lease, which any user can put under the name.
OwnedDescriptor open_region_file(std::string_view stream, RegionKind kind, bool writable) {
  const std::string path = region_path(stream, kind);
  const int access = writable ? O_RDWR : O_RDONLY;
  OwnedDescriptor opened = OwnedDescriptor::open(path, access | O_NOFOLLOW | O_NONBLOCK);
  if (opened.get() >= 0) return opened;
  switch (const int error = errno; error) {
    case ENOENT:
      throw NoSuchStream("there is no stream '" + std::string(stream) + "' with a " +
                         std::string(owner_role(kind)));
    case ELOOP:   // a symbolic link
    case ENXIO:   // a socket
    case EISDIR:  // a directory, opened for writing
      throw BadRegion(path + " is not a regular file");
    default:
      throw_failure("cannot open " + path, error);
  }
}

/// The status of an open region's file. Throws BadRegion if the file is not trusted.
struct stat trusted_status(int descriptor, const std::string& path, const Trust& trust) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) throw BadRegion(path + ": " + error_text(errno));
  require_trusted(status, path, trust);
  return status;
}

}  // namespace

/// What create() and open() make: a descriptor and Boost's mapping of it.
struct Region::Mapping {
  OwnedDescriptor descriptor;
  bip::mapped_region region;
  bool memory_locked = false;

  Mapping(OwnedDescriptor opened, bool writable)
      : descriptor(std::move(opened)),
        region(DescriptorMapping(descriptor.get()), writable ? bip::read_write : bip::read_only) {
    const auto all = bytes();
    populate(all, writable, descriptor.get());
    // After mapping: MAP_LOCKED would make mmap fail where the limit is small.
    memory_locked = mlock(all.data(), all.size()) == 0;
    // A forked child must not be a second writer.
    if (writable) madvise(all.data(), all.size(), MADV_DONTFORK);
  }
  [[nodiscard]] std::span<std::byte> bytes() const noexcept {
    return {static_cast<std::byte*>(region.get_address()), region.get_size()};
  }
};

Region::Region(std::unique_ptr<Mapping> mapping) : mapping_(std::move(mapping)) {}
Region::Region(Region&&) noexcept = default;
Region& Region::operator=(Region&&) noexcept = default;
Region::~Region() = default;

std::span<std::byte> Region::bytes() const noexcept { return mapping_->bytes(); }
int Region::descriptor() const noexcept { return mapping_->descriptor.get(); }
void Region::close_descriptor() noexcept { mapping_->descriptor = OwnedDescriptor(); }
bool Region::is_memory_locked() const noexcept { return mapping_->memory_locked; }

Region Region::create(std::size_t bytes, const RegionAccess& access) {
  const std::string folder(kSharedMemoryFolder);
  OwnedDescriptor descriptor = OwnedDescriptor::open(folder, O_TMPFILE | O_RDWR, S_IRUSR | S_IWUSR);
  if (descriptor.get() < 0) throw_failure("cannot create shared memory in " + folder, errno);
  reserve_pages(descriptor.get(), bytes);
  if (access.group && fchown(descriptor.get(), static_cast<uid_t>(-1), *access.group) != 0) {
    throw BadRegion("cannot give the region to group " + std::to_string(*access.group) + ": " +
                    error_text(errno));
  }
  if (fchmod(descriptor.get(), access.mode) != 0) {
    throw BadRegion("cannot set the region's mode: " + error_text(errno));
  }
  return Region(naming_what(std::to_string(bytes) + " bytes of shared memory", [&] {
    return std::make_unique<Mapping>(std::move(descriptor), true);
  }));
}

Region Region::open(std::string_view stream, RegionKind kind, bool writable, const Trust& trust) {
  const std::string path = region_path(stream, kind);
  OwnedDescriptor opened = open_region_file(stream, kind, writable);
  const struct stat status = trusted_status(opened.get(), path, trust);
  const std::string size = std::to_string(status.st_size);
  if (static_cast<std::size_t>(status.st_size) < kBodyOffset) {
    throw BadRegion(path + " has " + size + " bytes, fewer than its first " +
                    std::to_string(kBodyOffset));
  }
  return Region(naming_what(path + " (" + size + " bytes)", [&] {
    return std::make_unique<Mapping>(std::move(opened), writable);
  }));
}

bool Region::link(std::string_view stream, RegionKind kind) const {
  const std::string self = "/proc/self/fd/" + std::to_string(descriptor());
  const std::string path = region_path(stream, kind);
  if (linkat(AT_FDCWD, self.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0) return true;
  if (errno == EEXIST) return false;
  throw_failure("cannot link the region to " + path, errno);
}

bool Region::is_linked(std::string_view stream, RegionKind kind) const noexcept {
  struct stat mapped {};
  struct stat named {};
  return fstat(descriptor(), &mapped) == 0 &&
         lstat(region_path(stream, kind).c_str(), &named) == 0 && mapped.st_dev == named.st_dev &&
         mapped.st_ino == named.st_ino;
}

RegionFile look_at_region(std::string_view stream, RegionKind kind, const Trust& trust) {
  const OwnedDescriptor opened = open_region_file(stream, kind, false);
  const struct stat status = trusted_status(opened.get(), region_path(stream, kind), trust);
  RegionFile file{.bytes = static_cast<std::size_t>(status.st_size),
                  .is_own = status.st_uid == geteuid()};
  std::array<Word, kHeaderWords> words{};
  if (pread(opened.get(), words.data(), sizeof words, 0) == sizeof words) {
    file.header = decode_header(words);
  }
  return file;
}

std::optional<RegionHeader> peek_header(std::string_view stream, RegionKind kind,
                                        const Trust& trust) {
  try {
    return look_at_region(stream, kind, trust).header;
  } catch (const NoSuchStream&) {
    return std::nullopt;
  }
}

bool region_exists(std::string_view stream, RegionKind kind) {
  struct stat status {};
  return lstat(region_path(stream, kind).c_str(), &status) == 0;
}

void unlink_region(std::string_view stream, RegionKind kind) noexcept {
  unlink(region_path(stream, kind).c_str());
}

std::uint64_t time_namespace() noexcept {
  struct stat status {};
  return stat("/proc/self/ns/time", &status) == 0 ? status.st_ino : 0;
}

std::uint64_t random_id() {
  std::uint64_t id = 0;
  while (id == 0) {
    if (getrandom(&id, sizeof id, 0) != sizeof id) {
      throw BadRegion("cannot get random numbers: " + error_text(errno));
    }
  }
  return id;
}

}  // namespace splinecast::ipc
