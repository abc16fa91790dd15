#include "ipc/memory/names.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <system_error>

#include "ipc/memory/system_failure.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::ipc {
namespace {

constexpr std::string_view kPrefix = "splinecast.";
constexpr std::string_view kLockSuffix = ".lock";
constexpr std::size_t kMaxNameLength = 128;
constexpr char kOfCommander = '@';
constexpr char kOfStopper = '!';
constexpr std::string_view kSeparators = "@!";

constexpr std::array kKinds{RegionKind::waypoints, RegionKind::spline, RegionKind::commander,
                            RegionKind::stopper};

std::string_view suffix(RegionKind kind) noexcept {
  switch (kind) {
    case RegionKind::waypoints:
      return ".waypoints";
    case RegionKind::spline:
      return ".spline";
    case RegionKind::commander:
      return ".commander";
    case RegionKind::stopper:
      break;
  }
  return ".stopper";
}

bool is_name_character(char c) noexcept {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
         c == '_' || c == '-';
}

/// Whether a region of this kind can have the name.
bool is_region_name(std::string_view stream, RegionKind kind) noexcept {
  if (is_stream_name(stream)) return kind != RegionKind::stopper;
  const auto [of, name] = split_requester(stream);
  if (!is_stream_name(of) || !is_stream_name(name)) return false;
  return (stream[of.size()] == kOfStopper) == (kind == RegionKind::stopper);
}

std::string requester_stream(std::string_view of, char separator, std::string_view name) {
  require_stream_name(of);
  require_stream_name(name);
  return std::string(of).append(1, separator).append(name);
}

/// Bytes of the UTF-8 character at the start of a text, if it can be printed unchanged; 0 for a
/// control character and for invalid UTF-8.
std::size_t printable_bytes(std::string_view text) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7f ? 1 : 0;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
  char32_t point = first & (0x7fU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0U) != 0x80U) return 0;
    point = point << 6U | (byte(i) & 0x3fU);
  }
  constexpr std::array<char32_t, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
  const bool is_character =
      point >= kLeast[length] && point <= 0x10ffff && (point < 0xd800 || point > 0xdfff);
  // U+0080 to U+009F are control characters; U+2028 and 2029 are line ends; the others change the
  // direction of the text.
  const bool is_control =
      point < 0xa0 || (point >= 0x2028 && point <= 0x202e) || (point >= 0x2066 && point <= 0x2069);
  return is_character && !is_control ? length : 0;
}

}  // namespace

bool is_stream_name(std::string_view text) noexcept {
  return !text.empty() && text.size() <= kMaxNameLength && text.front() != '.' &&
         std::ranges::all_of(text, is_name_character);
}

std::string_view owner_role(RegionKind kind) noexcept {
  switch (kind) {
    case RegionKind::waypoints:
      return "producer";
    case RegionKind::spline:
      return "solver";
    case RegionKind::commander:
      return "commander";
    case RegionKind::stopper:
      break;
  }
  return "stopper";
}

void require_stream_name(std::string_view stream) {
  if (is_stream_name(stream)) return;
  throw BadRequest("'" + printable(stream) +
                   "' cannot name a stream: a name has 1 to 128 characters of A-Z a-z 0-9 . _ - "
                   "and no leading dot");
}

std::string printable(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out;
  while (!text.empty()) {
    const std::size_t bytes = printable_bytes(text);
    if (bytes > 0) {
      out.append(text.substr(0, bytes));
    } else {
      const auto byte = static_cast<unsigned char>(text.front());
      out.append("\\x").append({kDigits[byte >> 4U], kDigits[byte & 0xfU]});
    }
    text.remove_prefix(std::max<std::size_t>(bytes, 1));
  }
  return out;
}

std::string commander_stream(std::string_view law, std::string_view commander) {
  return requester_stream(law, kOfCommander, commander);
}

std::string stopper_stream(std::string_view stream, std::string_view stopper) {
  return requester_stream(stream, kOfStopper, stopper);
}

std::optional<RegionFileName> region_in(std::string_view file) noexcept {
  if (!file.starts_with(kPrefix)) return std::nullopt;
  file.remove_prefix(kPrefix.size());
  const bool is_lock = file.ends_with(kLockSuffix);
  if (is_lock) file.remove_suffix(kLockSuffix.size());
  for (const RegionKind kind : kKinds) {
    if (!file.ends_with(suffix(kind))) continue;
    file.remove_suffix(suffix(kind).size());
    if (!is_region_name(file, kind)) break;
    return RegionFileName{.stream = file, .kind = kind, .is_lock = is_lock};
  }
  return std::nullopt;
}

std::pair<std::string_view, std::string_view> split_requester(std::string_view stream) noexcept {
  const std::size_t at = std::min(stream.find_first_of(kSeparators), stream.size());
  return {stream.substr(0, at), stream.substr(std::min(at + 1, stream.size()))};
}

void for_each_region(const std::function<void(const RegionFileName& region)>& take) {
  std::error_code error;
  std::filesystem::directory_iterator entry(kSharedMemoryFolder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    const std::string file = entry->path().filename();
    if (const auto region = region_in(file)) take(*region);
  }
  if (error) throw_failure("cannot read " + std::string(kSharedMemoryFolder), error.value());
}

std::vector<std::string> requester_names(std::string_view of, RegionKind kind) {
  require_stream_name(of);
  std::set<std::string> names;
  for_each_region([&](const RegionFileName& region) {
    const auto [owner, name] = split_requester(region.stream);
    const bool is_stopper = region.kind == RegionKind::stopper;
    if (owner == of && !name.empty() && is_stopper == (kind == RegionKind::stopper)) {
      names.emplace(name);
    }
  });
  return {names.begin(), names.end()};
}

std::string region_name(std::string_view stream, RegionKind kind) {
  const std::size_t at = stream.find_first_of(kSeparators);
  require_stream_name(stream.substr(0, at));
  if (at != std::string_view::npos) require_stream_name(stream.substr(at + 1));
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

}  // namespace splinecast::ipc

namespace splinecast {

std::vector<std::string> stream_names() {
  std::set<std::string> names;
  ipc::for_each_region([&](const ipc::RegionFileName& region) {
    if (ipc::is_stream_name(region.stream)) names.emplace(region.stream);
  });
  return {names.begin(), names.end()};
}

}  // namespace splinecast
