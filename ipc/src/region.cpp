#include "splinecast/ipc/region.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <boost/interprocess/mapped_region.hpp>
#include <boost/interprocess/shared_memory_object.hpp>
#include <cerrno>
#include <system_error>
#include <utility>

#include "splinecast/ipc/errors.hpp"
#include "splinecast/ipc/layout.hpp"
#include "splinecast/ipc/mode_text.hpp"
#include "splinecast/ipc/owned_descriptor.hpp"

namespace splinecast::ipc {
namespace {

namespace bip = boost::interprocess;

std::string error_text(int error) { return std::generic_category().message(error); }

/// Lends a descriptor to boost::interprocess::mapped_region.
class DescriptorMapping {
 public:
  explicit DescriptorMapping(int descriptor) : descriptor_(descriptor) {}
  [[nodiscard]] bip::mapping_handle_t get_mapping_handle() const {
    return bip::ipcdetail::mapping_handle_from_file_handle(descriptor_);
  }

 private:
  int descriptor_;
};

int duplicate(int descriptor) {
  const int copy = fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
  if (copy < 0) throw BadRegion("no file descriptor for a region: " + error_text(errno));
  return copy;
}

/// Bytes free in the file system of an open file.
std::string free_bytes(int descriptor) {
  struct statvfs status {};
  fstatvfs(descriptor, &status);
  return std::to_string(status.f_bavail * status.f_frsize);
}

/// What `map` returns; boost's errors do not say what could not be mapped.
template <typename Map>
auto naming_what(const std::string& what, const Map& map) {
  try {
    return map();
  } catch (const bip::interprocess_exception& error) {
    throw BadRegion("cannot map " + what + ": " + error.what());
  }
}

/// Beyond this limit the kernel would end the process with SIGXFSZ rather than refuse.
void require_file_size(std::size_t bytes) {
  struct rlimit limit {};
  if (getrlimit(RLIMIT_FSIZE, &limit) != 0 || bytes <= limit.rlim_cur) return;
  throw BadRegion("cannot reserve " + std::to_string(bytes) +
                  " bytes of shared memory: this process's files may have " +
                  std::to_string(limit.rlim_cur) + " (RLIMIT_FSIZE)");
}

void reserve_pages(int descriptor, std::size_t bytes) {
  require_file_size(bytes);
  const int error = posix_fallocate(descriptor, 0, static_cast<off_t>(bytes));
  if (error == 0) return;
  throw BadRegion("cannot reserve " + std::to_string(bytes) + " bytes of shared memory, " +
                  free_bytes(descriptor) + " are free: " + error_text(error));
}

/// Faults every page in now, so that no sample, append or solve ever does.
void populate(std::span<std::byte> bytes, bool writable, int descriptor) {
  const int advice = writable ? MADV_POPULATE_WRITE : MADV_POPULATE_READ;
  if (madvise(bytes.data(), bytes.size(), advice) == 0) return;
  if (errno != EINVAL) {
    // A file with holes that there is no memory for: to touch them would be a SIGBUS.
    throw BadRegion("cannot populate " + std::to_string(bytes.size()) +
                    " bytes of shared memory, " + free_bytes(descriptor) +
                    " are free: " + error_text(errno));
  }
  // A kernel before 5.14.
  for (std::size_t at = 0; at < bytes.size(); at += kPage) {
    (void)load(words_at(std::span<const std::byte>(bytes), at, 1)[0], std::memory_order_relaxed);
  }
}

void require_trusted(int descriptor, const std::string& path, const Trust& trust) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) throw BadRegion(path + ": " + error_text(errno));
  if (!S_ISREG(status.st_mode)) throw BadRegion(path + " is no regular file");
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

bip::shared_memory_object open_shared_memory(std::string_view stream, RegionKind kind,
                                             bool writable) {
  const std::string name = region_name(stream, kind);
  struct stat status {};
  if (lstat(region_path(stream, kind).c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
    // Said before opening: opening a FIFO would hang.
    throw BadRegion(region_path(stream, kind) + " is no regular file");
  }
  try {
    return {bip::open_only, name.c_str(), writable ? bip::read_write : bip::read_only};
  } catch (const bip::interprocess_exception& error) {
    if (error.get_error_code() == bip::not_found_error) {
      throw NoSuchStream("there is no stream '" + std::string(stream) + "' with a " +
                         std::string(owner_role(kind)));
    }
    throw BadRegion("cannot open " + region_path(stream, kind) + ": " + error.what());
  }
}

}  // namespace

/// Both ways to a region end in a descriptor and boost's mapping of it.
struct Region::Mapping {
  OwnedDescriptor descriptor;
  bip::mapped_region region;
  bool memory_locked = false;

  Mapping(int owned, bool writable)
      : descriptor(owned),
        region(DescriptorMapping(owned), writable ? bip::read_write : bip::read_only) {
    const auto all = bytes();
    populate(all, writable, owned);
    // After the mapping stands: MAP_LOCKED would make it fail where the limit is small.
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
  OwnedDescriptor descriptor(
      ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (descriptor.get() < 0) {
    throw BadRegion("cannot make shared memory in " + folder + ": " + error_text(errno));
  }
  reserve_pages(descriptor.get(), bytes);
  if (access.group && fchown(descriptor.get(), static_cast<uid_t>(-1), *access.group) != 0) {
    throw BadRegion("cannot give the region to group " + std::to_string(*access.group) + ": " +
                    error_text(errno));
  }
  if (fchmod(descriptor.get(), access.mode) != 0) {
    throw BadRegion("cannot set the region's mode: " + error_text(errno));
  }
  return Region(naming_what(std::to_string(bytes) + " bytes of shared memory", [&] {
    return std::make_unique<Mapping>(duplicate(descriptor.get()), true);
  }));
}

Region Region::open(std::string_view stream, RegionKind kind, bool writable, const Trust& trust) {
  const auto object = open_shared_memory(stream, kind, writable);
  const int descriptor = object.get_mapping_handle().handle;
  require_trusted(descriptor, region_path(stream, kind), trust);
  struct stat status {};
  fstat(descriptor, &status);
  if (static_cast<std::size_t>(status.st_size) < kBodyOffset) {
    throw BadRegion(region_path(stream, kind) + " has " + std::to_string(status.st_size) +
                    " bytes, fewer than its first " + std::to_string(kBodyOffset));
  }
  return Region(
      naming_what(region_path(stream, kind) + " (" + std::to_string(status.st_size) + " bytes)",
                  [&] { return std::make_unique<Mapping>(duplicate(descriptor), writable); }));
}

bool Region::link(std::string_view stream, RegionKind kind) const {
  const std::string self = "/proc/self/fd/" + std::to_string(descriptor());
  const std::string path = region_path(stream, kind);
  if (linkat(AT_FDCWD, self.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0) return true;
  if (errno == EEXIST) return false;
  throw BadRegion("cannot name the region " + path + ": " + error_text(errno));
}

bool Region::is_linked(std::string_view stream, RegionKind kind) const noexcept {
  struct stat mapped {};
  struct stat named {};
  return fstat(descriptor(), &mapped) == 0 &&
         lstat(region_path(stream, kind).c_str(), &named) == 0 && mapped.st_dev == named.st_dev &&
         mapped.st_ino == named.st_ino;
}

std::optional<RegionHeader> peek_header(std::string_view stream, RegionKind kind,
                                        const Trust& trust) {
  try {
    const auto object = open_shared_memory(stream, kind, false);
    const int descriptor = object.get_mapping_handle().handle;
    require_trusted(descriptor, region_path(stream, kind), trust);
    RegionHeader header{};
    const bool whole = pread(descriptor, &header, sizeof header, 0) == sizeof header;
    return whole ? std::optional(header) : std::nullopt;
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
      throw BadRegion("no random numbers: " + error_text(errno));
    }
  }
  return id;
}

}  // namespace splinecast::ipc
