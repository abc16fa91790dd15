#include "apps/files/input_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/interprocess/mapped_region.hpp>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "apps/process/exit_codes.hpp"
#include "ipc/memory/descriptor.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps {

namespace bip = boost::interprocess;

namespace {

/// Size of a pipe's contents from which they are kept in a file.
constexpr std::size_t kMostInMemory = std::size_t{16} << 20U;

/// Passes a descriptor to boost::interprocess::mapped_region.
struct DescriptorMapping {
  int descriptor;
  [[nodiscard]] bip::mapping_handle_t get_mapping_handle() const {
    return bip::ipcdetail::mapping_handle_from_file_handle(descriptor);
  }
};

/// Reads until the buffer is full or the input ends. Returns the bytes, -1 on failure.
ssize_t read_fully(int descriptor, std::span<char> out) {
  std::size_t bytes = 0;
  while (bytes < out.size()) {
    const ssize_t part = ::read(descriptor, out.data() + bytes, out.size() - bytes);
    if (part == 0) break;
    if (part < 0 && errno != EINTR) return -1;
    if (part > 0) bytes += static_cast<std::size_t>(part);
  }
  return static_cast<ssize_t>(bytes);
}

bool write_fully(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t part = ::write(descriptor, text.data(), text.size());
    if (part < 0 && errno != EINTR) return false;
    if (part > 0) text.remove_prefix(static_cast<std::size_t>(part));
  }
  return true;
}

/// A file without a name in $TMPDIR or /tmp; empty if there can be none.
ipc::OwnedDescriptor open_unnamed() {
  const char* const folder = std::getenv("TMPDIR");  // NOLINT(concurrency-mt-unsafe)
  return ipc::OwnedDescriptor::open(folder != nullptr && *folder != '\0' ? folder : "/tmp",
                                    O_TMPFILE | O_RDWR, 0600);
}

bool are_equal(const timespec& a, const timespec& b) {
  return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
}

}  // namespace

struct InputFile::Storage {
  ipc::OwnedDescriptor file;  ///< unused if the contents are in `copy`
  std::string copy;
  bool is_copied = false;
  struct stat opened {};
  bip::mapped_region mapping;
};

InputFile::InputFile(const std::string& path)
    : name_(path == "-" ? "<stdin>" : ipc::printable(path)), storage_(std::make_unique<Storage>()) {
  if (path == "-") {
    copy_pipe(STDIN_FILENO);
    return;
  }
  // Check the open descriptor, so that the file that is checked is the file that is read.
  storage_->file = ipc::OwnedDescriptor::open(path, O_RDONLY);
  const int file = storage_->file.get();
  if (file < 0 || fstat(file, &storage_->opened) != 0) refuse(errno);
  if (S_ISDIR(storage_->opened.st_mode)) throw InputError(fmt::format("{}: is a directory", name_));
  if (!S_ISREG(storage_->opened.st_mode)) {
    copy_pipe(file);
    return;
  }
  size_ = static_cast<std::uint64_t>(storage_->opened.st_size);
}

InputFile::InputFile(InputFile&&) noexcept = default;
InputFile& InputFile::operator=(InputFile&&) noexcept = default;
InputFile::~InputFile() = default;

void InputFile::refuse(int error) const {
  if (error == ENOENT || error == ENOTDIR) {
    throw InputError(fmt::format("{}: no such file", name_));
  }
  throw InputError(
      fmt::format("{}: cannot be read: {}", name_, std::generic_category().message(error)));
}

void InputFile::copy_pipe(int descriptor) {
  Storage& storage = *storage_;
  std::array<char, 65536> block{};
  ipc::OwnedDescriptor unnamed;
  bool is_small = true;
  for (ssize_t bytes = 0; (bytes = read_fully(descriptor, block)) != 0;) {
    if (bytes < 0) refuse(errno);
    const std::string_view part(block.data(), static_cast<std::size_t>(bytes));
    size_ += part.size();
    if (is_small && storage.copy.size() + part.size() > kMostInMemory) {
      is_small = false;
      unnamed = open_unnamed();
      if (unnamed.get() >= 0) append_to(unnamed.get(), std::exchange(storage.copy, {}));
    }
    if (unnamed.get() >= 0) {
      append_to(unnamed.get(), part);
    } else {
      storage.copy += part;
    }
  }
  storage.is_copied = unnamed.get() < 0;
  if (storage.is_copied) return;
  if (fstat(unnamed.get(), &storage.opened) != 0) refuse(errno);
  storage.file = std::move(unnamed);
}

/// Appends to the copy of a pipe. Throws InputError if the disk is full.
void InputFile::append_to(int descriptor, std::string_view part) const {
  if (write_fully(descriptor, part)) return;
  throw InputError(fmt::format("{}: cannot be copied to a temporary file: {}", name_,
                               std::generic_category().message(errno)));
}

std::size_t InputFile::read(std::uint64_t offset, std::span<char> out) {
  if (offset >= size_) return 0;
  const auto bytes = static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), size_ - offset));
  if (storage_->is_copied) return storage_->copy.copy(out.data(), bytes, offset);
  std::size_t done = 0;
  while (done < bytes) {
    const ssize_t part = pread(storage_->file.get(), out.data() + done, bytes - done,
                               static_cast<off_t>(offset + done));
    if (part < 0 && errno != EINTR) refuse(errno);
    if (part == 0) throw InputError(fmt::format("{}: was truncated while it was read", name_));
    if (part > 0) done += static_cast<std::size_t>(part);
  }
  if (is_same_required_) require_unchanged();
  return bytes;
}

void InputFile::require_unchanged() const {
  struct stat now {};
  if (fstat(storage_->file.get(), &now) != 0) refuse(errno);
  if (now.st_size == storage_->opened.st_size && are_equal(now.st_mtim, storage_->opened.st_mtim)) {
    return;
  }
  throw InputError(fmt::format("{}: was changed after it had been read for the first time", name_));
}

std::string_view InputFile::mapped() {
  if (storage_->is_copied) return storage_->copy;
  if (size_ == 0) return {};  // an empty file cannot be mapped
  if (storage_->mapping.get_address() == nullptr) {
    try {
      storage_->mapping =
          bip::mapped_region(DescriptorMapping{storage_->file.get()}, bip::read_only, 0, size_);
    } catch (const bip::interprocess_exception& refused) {
      throw InputError(fmt::format("{}: cannot be read: {}", name_, refused.what()));
    }
  }
  return {static_cast<const char*>(storage_->mapping.get_address()), size_};
}

}  // namespace splinecast::apps
