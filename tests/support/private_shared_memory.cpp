#include "support/private_shared_memory.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <functional>
#include <stdexcept>

namespace splinecast::testing {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnshare = "/usr/bin/unshare";

/// Makes the namespace, mounts, and goes on as `last`.
std::vector<std::string> in_namespace(const std::string& size, const std::string& last) {
  std::vector<std::string> arguments{"--mount"};
  if (geteuid() != 0) arguments.emplace_back("--map-root-user");
  arguments.insert(
      arguments.end(),
      {"sh", "-c", "mount -t tmpfs -o mode=1777,size=" + size + " tmpfs /dev/shm && " + last});
  return arguments;
}

std::string describe(const fs::path& path) {
  struct stat status {};
  if (lstat(path.c_str(), &status) != 0) return "gone";
  std::string bytes;
  if (S_ISLNK(status.st_mode)) bytes = fs::read_symlink(path);
  if (S_ISREG(status.st_mode)) bytes = read_file(path);
  return fmt::format("mode {:o}, owner {}, group {}, {} bytes, hash {:x}", status.st_mode,
                     status.st_uid, status.st_gid, status.st_size, std::hash<std::string>()(bytes));
}

}  // namespace

bool PrivateSharedMemory::is_allowed() {
  static const bool allowed = Process(kUnshare, in_namespace("64k", "true")).wait().code == 0;
  return allowed;
}

PrivateSharedMemory::PrivateSharedMemory(const std::string& size)
    : holder_(kUnshare, in_namespace(size, "echo mounted >&2 && exec tail -f /dev/null")),
      folder_(fmt::format("/proc/{}/root/dev/shm", holder_.pid())) {
  holder_.await_message("mounted");
}

Process PrivateSharedMemory::start(const std::string& program,
                                   const std::vector<std::string>& arguments,
                                   const Confinement& who) const {
  std::vector<std::string> all{"--target", std::to_string(holder_.pid()), "--mount"};
  if (geteuid() != 0) all.insert(all.end(), {"--user", "--preserve-credentials"});
  all.emplace_back("--");
  all.insert(all.end(), who.wrapper.begin(), who.wrapper.end());
  if (!who.limits.empty()) {
    all.emplace_back("prlimit");
    all.insert(all.end(), who.limits.begin(), who.limits.end());
  }
  if (geteuid() == 0) {
    const std::string groups = fmt::format("{}", fmt::join(who.groups, ","));
    all.insert(all.end(), {"setpriv", "--reuid", std::to_string(who.user), "--regid",
                           std::to_string(who.group), "--pdeathsig", "KILL"});
    if (groups.empty()) {
      all.emplace_back("--clear-groups");
    } else {
      all.insert(all.end(), {"--groups", groups});
    }
  }
  all.push_back(program);
  all.insert(all.end(), arguments.begin(), arguments.end());
  return {"/usr/bin/nsenter", all};
}

Process PrivateSharedMemory::start(const std::vector<std::string>& arguments,
                                   const Confinement& who) const {
  return start(SPLINECAST_PROGRAM, arguments, who);
}

Ended PrivateSharedMemory::run(const std::vector<std::string>& arguments,
                               const Confinement& who) const {
  return start(arguments, who).wait();
}

std::map<std::string, std::string> PrivateSharedMemory::listing() const {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    files[entry.path().filename()] = describe(entry.path());
  }
  return files;
}

}  // namespace splinecast::testing
