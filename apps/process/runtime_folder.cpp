#include "apps/process/runtime_folder.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "apps/process/exit_codes.hpp"

namespace splinecast::apps {
namespace {

std::string temporary_folder(uid_t user) { return fmt::format("/tmp/splinecast-{}", user); }

bool is_own(const std::string& folder, uid_t user) noexcept {
  struct stat status {};
  return lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == user &&
         (status.st_mode & 077U) == 0;
}

}  // namespace

std::vector<std::string> runtime_folders(uid_t user) {
  std::vector<std::string> folders;
  const auto add = [&](const std::string& folder) {
    if (folder.starts_with('/') && is_own(folder, user)) folders.push_back(folder);
  };
  if (user == geteuid()) {
    const char* const given = std::getenv("XDG_RUNTIME_DIR");  // NOLINT(concurrency-mt-unsafe)
    if (given != nullptr) add(given);
  }
  add(fmt::format("/run/user/{}", user));
  add(temporary_folder(user));
  return folders;
}

std::string own_runtime_folder() {
  const uid_t user = geteuid();
  std::vector<std::string> folders = runtime_folders(user);
  if (folders.empty()) {
    const std::string folder = temporary_folder(user);
    if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
      throw Failure(fmt::format("cannot create {}: {}", folder, std::strerror(errno)));
    }
    if (!is_own(folder, user)) {
      throw Failure(
          fmt::format("{} is not a folder of this user with mode 0700: it is needed for the socket "
                      "of triggers; "
                      "set XDG_RUNTIME_DIR to one",
                      folder));
    }
    folders.push_back(folder);
  }
  return folders.front();
}

}  // namespace splinecast::apps
