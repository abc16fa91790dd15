#include "splinecast/ipc/names.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include "splinecast/ipc/errors.hpp"

namespace splinecast::ipc {
namespace {

constexpr std::string_view kPrefix = "splinecast.";
constexpr std::string_view kLockSuffix = ".lock";
constexpr std::size_t kMaxNameLength = 128;

constexpr std::array kKinds{RegionKind::waypoints, RegionKind::spline};

std::string_view suffix(RegionKind kind) noexcept {
  return kind == RegionKind::waypoints ? ".waypoints" : ".spline";
}

bool is_name_character(char c) noexcept {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
         c == '_' || c == '-';
}

/// The stream that a file belongs to, or an empty view.
std::string_view stream_of(std::string_view file) noexcept {
  if (!file.starts_with(kPrefix)) return {};
  file.remove_prefix(kPrefix.size());
  if (file.ends_with(kLockSuffix)) file.remove_suffix(kLockSuffix.size());
  for (const RegionKind kind : kKinds) {
    if (!file.ends_with(suffix(kind))) continue;
    file.remove_suffix(suffix(kind).size());
    return file;
  }
  return {};
}

}  // namespace

std::string_view owner_role(RegionKind kind) noexcept {
  return kind == RegionKind::waypoints ? "producer" : "solver";
}

void require_stream_name(std::string_view stream) {
  const bool fits = !stream.empty() && stream.size() <= kMaxNameLength && stream.front() != '.' &&
                    std::ranges::all_of(stream, is_name_character);
  if (!fits) {
    throw BadRequest("'" + std::string(stream) +
                     "' cannot name a stream: 1 to 128 of A-Z a-z 0-9 . _ - are needed, "
                     "the first no dot");
  }
}

std::string region_name(std::string_view stream, RegionKind kind) {
  require_stream_name(stream);
  return std::string(kPrefix).append(stream).append(suffix(kind));
}

std::string region_path(std::string_view stream, RegionKind kind) {
  return std::string(kSharedMemoryFolder) + region_name(stream, kind);
}

std::string lock_path(std::string_view stream, RegionKind kind) {
  return region_path(stream, kind).append(kLockSuffix);
}

bool is_pattern(std::string_view text) noexcept {
  return text.find_first_of("*?[") != std::string_view::npos;
}

bool matches(const std::string& pattern, const std::string& stream) noexcept {
  return fnmatch(pattern.c_str(), stream.c_str(), 0) == 0;
}

std::vector<std::string> stream_names() {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kSharedMemoryFolder)) {
    const std::string file = entry.path().filename();
    const std::string_view stream = stream_of(file);
    if (!stream.empty()) names.emplace(stream);
  }
  return {names.begin(), names.end()};
}

}  // namespace splinecast::ipc
