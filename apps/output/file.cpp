#include "apps/output/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "apps/process/exit_codes.hpp"

namespace splinecast::apps {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kPermissions = 07777;
constexpr mode_t kNewFile = 0666;  // minus the umask

[[noreturn]] void fail(const std::string& path) {
  throw Failure(
      fmt::format("{}: cannot be written: {}", path, std::generic_category().message(errno)));
}

/// The status of the file at a path or, with `is_standard`, of a standard stream. nullopt unless it
/// exists and is regular.
std::optional<struct stat> regular_file(const std::string& path, bool is_standard, int standard) {
  struct stat status {};
  const int found = is_standard ? fstat(standard, &status) : stat(path.c_str(), &status);
  if (found != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return status;
}

bool is_same(const std::optional<struct stat>& a, const std::optional<struct stat>& b) {
  return a && b && a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

/// Whether a file is under /dev or /proc. Such a file is written directly, never replaced.
bool is_special(const std::string& file) {
  return file.starts_with("/dev/") || file.starts_with("/proc/");
}

/// The target of a chain of symbolic links. The target need not exist.
std::string resolve_links(const std::string& path) {
  constexpr int kMostLinks = 40;  // as in the kernel
  fs::path at(path);
  for (int links = 0; links < kMostLinks; ++links) {
    std::error_code error;
    if (is_special(at) || !fs::is_symlink(fs::symlink_status(at, error))) return at;
    const fs::path to = fs::read_symlink(at, error);
    if (error) break;
    at = to.is_absolute() ? to : at.parent_path() / to;
  }
  errno = ELOOP;
  fail(path);
}

/// Whether two paths are the same. Works for files that do not exist yet.
bool is_same_path(const std::string& a, const std::string& b) {
  std::error_code error;
  if (a.empty() || b.empty() || is_special(a)) return false;
  return fs::weakly_canonical(a, error) == fs::weakly_canonical(b, error);
}

std::string folder_of(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  return folder.empty() ? "." : folder.string();
}

}  // namespace

void require_separate(std::span<const std::string> outputs, std::span<const std::string> inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const std::string& output = outputs[i];
    const std::string name = output.empty() ? "standard output" : output;
    const auto file = regular_file(output, output.empty(), STDOUT_FILENO);
    for (const std::string& input : inputs) {
      if (input.empty() || !is_same(file, regular_file(input, input == "-", STDIN_FILENO))) {
        continue;
      }
      throw InputError(
          fmt::format("{}: is an input too ('{}'): it would be overwritten", name, input));
    }
    for (const std::string& other : outputs.first(i)) {
      const bool is_one = is_same(file, regular_file(other, other.empty(), STDOUT_FILENO)) ||
                          is_same_path(output, other);
      if (is_one) throw InputError(fmt::format("{}: is given for two outputs", name));
    }
  }
}

OutputFile::OutputFile(const std::string& path, Writing writing) : target_(resolve_links(path)) {
  struct stat status {};
  const bool exists = stat(target_.c_str(), &status) == 0;
  const bool is_replaced =
      writing == Writing::whole && !is_special(target_) && (!exists || S_ISREG(status.st_mode));
  int descriptor = is_replaced ? open_replacement() : -1;
  if (descriptor < 0 && temporary_.empty()) {
    descriptor =
        open(target_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOCTTY, kNewFile);
  }
  if (descriptor < 0) fail(path);
  file_ = fdopen(descriptor, "w");
  if (file_ != nullptr) return;
  close(descriptor);
  if (is_named_) unlink(temporary_.c_str());
  fail(path);
}

/// Opens the file that will replace the target. A negative result with an empty `temporary_` means
/// that the target must be written directly, because no file can be created in its directory or
/// given its owner. Any other negative result is an error.
int OutputFile::open_replacement() {
  struct stat old {};
  const bool exists = stat(target_.c_str(), &old) == 0;
  // rename() does not need write permission for the target. Do not replace a protected file.
  if (exists && access(target_.c_str(), W_OK) != 0) {
    temporary_ = target_;
    return -1;
  }
  const int descriptor = open_temporary();
  if (descriptor < 0 || !exists) return descriptor;
  const bool has_same_owner = old.st_uid == geteuid() && old.st_gid == getegid();
  if ((has_same_owner || fchown(descriptor, old.st_uid, old.st_gid) == 0) &&
      fchmod(descriptor, old.st_mode & kPermissions) == 0) {
    return descriptor;
  }
  // A new file would have another owner: overwrite the old file instead.
  if (is_named_) unlink(temporary_.c_str());
  is_named_ = false;
  temporary_.clear();
  close(descriptor);
  return -1;
}

/// Opens a file in the target's directory, without a name if possible (O_TMPFILE).
int OutputFile::open_temporary() {
  const std::string folder = folder_of(target_);
  static int count = 0;
  const std::string name = fmt::format("{}/.splinecast.{}.{}", folder, getpid(), count++);
  int descriptor = open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, kNewFile);
  if (descriptor < 0) {
    descriptor = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kNewFile);
    is_named_ = descriptor >= 0;
  }
  const bool is_closed_folder = errno == EACCES || errno == EPERM || errno == EROFS;
  if (descriptor >= 0 || !is_closed_folder) temporary_ = name;
  return descriptor;
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) std::fclose(file_);
  if (is_named_) unlink(temporary_.c_str());
}

bool OutputFile::give_name() {
  if (temporary_.empty()) return true;
  if (!is_named_) {
    const std::string open_file = fmt::format("/proc/self/fd/{}", fileno(file_));
    if (linkat(AT_FDCWD, open_file.c_str(), AT_FDCWD, temporary_.c_str(), AT_SYMLINK_FOLLOW) != 0) {
      return false;
    }
    is_named_ = true;
  }
  if (rename(temporary_.c_str(), target_.c_str()) != 0) return false;
  is_named_ = false;
  return true;
}

bool OutputFile::commit() {
  if (std::fflush(file_) != 0 || !give_name()) return false;
  return std::fclose(std::exchange(file_, nullptr)) == 0;
}

}  // namespace splinecast::apps
