#include "apps/record/output/file_names.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "apps/process/exit_codes.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps::record {

FileNames::FileNames(std::string path) : path_(std::move(path)) {
  const std::filesystem::path whole(path_);
  extension_ = whole.extension().string();
  stem_ = path_.substr(0, path_.size() - extension_.size());
}

std::string FileNames::next(std::string_view kind, std::size_t least) {
  constexpr std::size_t kMost = 999'999;
  std::size_t& last = last_[std::string(kind)];
  for (std::size_t n = std::max(least, last + 1); n <= kMost; ++n) {
    std::string name =
        fmt::format("{}{}{}-{:04}{}", stem_, kind.empty() ? "" : ".", kind, n, extension_);
    std::error_code error;
    if (std::filesystem::exists(std::filesystem::symlink_status(name, error))) continue;
    last = n;
    return name;
  }
  throw Failure(fmt::format("there are {} files like {}", kMost, ipc::printable(path_)));
}

void FileNames::require_folder() const {
  std::filesystem::path folder = std::filesystem::path(path_).parent_path();
  if (folder.empty()) folder = ".";
  if (access(folder.c_str(), W_OK | X_OK) == 0 && std::filesystem::is_directory(folder)) return;
  throw Failure(fmt::format("cannot create files in {}: {}", ipc::printable(folder.string()),
                            std::strerror(errno != 0 ? errno : ENOTDIR)));
}

}  // namespace splinecast::apps::record
