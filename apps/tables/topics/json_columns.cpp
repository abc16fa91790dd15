#include "apps/tables/topics/json_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "apps/messages/message_error.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/time_column.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {
namespace {

constexpr std::array<std::string_view, 3> kStamps{"timestamp", "header.stamp", "stamp"};
constexpr std::array<std::string_view, 2> kNanoseconds{"nsec", "nanosec"};
constexpr std::string_view kSeconds = "sec";

JsonPath joined(JsonPath path, std::string_view step) {
  path.emplace_back(step);
  return path;
}

bool has(const std::vector<JsonPath>& paths, const JsonPath& path) {
  return std::ranges::find(paths, path) != paths.end();
}

/// The member of nanoseconds of the object at a path; empty if the first message has no time there.
std::string_view nanoseconds_of(const std::vector<JsonPath>& numbers, const JsonPath& path) {
  if (!has(numbers, joined(path, kSeconds))) return {};
  for (const std::string_view name : kNanoseconds) {
    if (has(numbers, joined(path, name))) return name;
  }
  return {};
}

/// Reads the time from an object with seconds and nanoseconds.
void take_object(JsonColumns& columns, const JsonPath& path, std::string_view nanoseconds) {
  columns.time = {
      .kind = JsonTime::Kind::object, .field = columns.paths.size(), .name = to_string(path)};
  columns.paths.push_back(joined(path, kSeconds));
  columns.paths.push_back(joined(path, nanoseconds));
}

void find_time(JsonColumns& columns, const std::vector<JsonPath>& numbers,
               const TableOptions& options) {
  if (!options.time_column.empty()) {
    const JsonPath path = parse_json_path(options.time_column);
    if (const auto nanoseconds = nanoseconds_of(numbers, path); !nanoseconds.empty()) {
      return take_object(columns, path, nanoseconds);
    }
    const auto named = unit_of_time_column(path.back());
    columns.time = {.kind = JsonTime::Kind::number,
                    .unit = options.time_unit.value_or(named.value_or(TimeUnit::seconds)),
                    .field = columns.paths.size(),
                    .name = to_string(path)};
    columns.paths.push_back(path);
    return;
  }
  if (options.which_time == WhichTime::header) {
    for (const std::string_view stamp : kStamps) {
      const JsonPath path = parse_json_path(stamp);
      const auto nanoseconds = nanoseconds_of(numbers, path);
      if (!nanoseconds.empty()) return take_object(columns, path, nanoseconds);
    }
  }
  columns.time.which =
      options.which_time == WhichTime::publish ? WhichTime::publish : WhichTime::log;
  columns.time.name = name_of_time(columns.time.which, "");
}

/// Whether a number belongs to a time: that of the rows, or one with seconds and nanoseconds.
bool is_of_time(const JsonPath& path, const std::vector<JsonPath>& numbers,
                const JsonColumns& columns) {
  if (has(columns.paths, path)) return true;
  JsonPath parent = path;
  parent.pop_back();
  return !nanoseconds_of(numbers, parent).empty() &&
         (path.back() == kSeconds ||
          std::ranges::find(kNanoseconds, path.back()) != kNanoseconds.end());
}

/// The kind of four numbers of one object; linear if they are not a quaternion.
DimensionKind kind_of(std::span<const JsonPath> four) {
  constexpr std::array<std::string_view, 4> kParents{"orientation", "rotation", "quaternion", "q"};
  std::string letters;
  for (const JsonPath& path : four) {
    const bool is_sibling = path.size() >= 2 && path.size() == four[0].size() &&
                            std::equal(path.begin(), path.end() - 1, four[0].begin());
    if (!is_sibling) return DimensionKind::linear;
    letters += path.back();
  }
  const std::string& parent = four[0][four[0].size() - 2];
  if (std::ranges::find(kParents, parent) == kParents.end()) return DimensionKind::linear;
  if (letters == "xyzw") return DimensionKind::quaternion;
  return letters == "wxyz" ? DimensionKind::quaternion_wxyz : DimensionKind::linear;
}

std::vector<Dimension> kinds_of(std::span<const JsonPath> paths) {
  std::vector<Dimension> kinds(paths.size());
  for (std::size_t d = 0; d + kQuaternionSize <= paths.size(); ++d) {
    const DimensionKind kind = kind_of(paths.subspan(d, kQuaternionSize));
    if (kind == DimensionKind::linear) continue;
    std::ranges::fill(std::span(kinds).subspan(d, kQuaternionSize), Dimension{.kind = kind});
    d += kQuaternionSize - 1;
  }
  return kinds;
}

}  // namespace

Time JsonTime::of(const TopicMessage& message, const JsonFields& fields) const {
  if (kind == Kind::message) return time_of(message, message.log_time, which);
  const std::string_view text = fields.text(field);
  const bool is_object = kind == Kind::object;
  auto time = parse_time(text, is_object ? TimeUnit::seconds : unit);
  if (time && is_object && is_time_in_range(*time)) {
    const auto rest = parse_time(fields.text(field + 1), TimeUnit::nanoseconds);
    const bool is_part = rest && *rest >= Time::zero() && *rest < std::chrono::seconds(1);
    time = is_part ? std::optional(*time + *rest) : std::nullopt;
  }
  if (!time) {
    throw MessageError(fmt::format("field '{}': {} is not a time", name,
                                   text.empty() ? "a missing value" : shown(text)));
  }
  return *time;
}

JsonColumns json_columns(std::string_view first, const TableOptions& options) {
  const std::vector<JsonPath> numbers = paths_of_numbers(first);
  JsonColumns columns;
  for (const std::string& name : chosen_names(options)) {
    columns.paths.push_back(parse_json_path(name));
  }
  if (columns.paths.empty()) {
    JsonColumns times;
    find_time(times, numbers, options);
    for (const JsonPath& path : numbers) {
      if (!is_of_time(path, numbers, times)) columns.paths.push_back(path);
    }
  }
  if (columns.paths.empty() || columns.paths.size() > kMaxDimensions) {
    throw InputError(fmt::format("its messages have {} numbers: choose 1 to {} with --field",
                                 columns.paths.size(), kMaxDimensions));
  }
  for (const JsonPath& path : columns.paths) columns.columns.names.push_back(to_string(path));
  columns.columns.kinds = kinds_of(columns.paths);
  find_time(columns, numbers, options);
  return columns;
}

}  // namespace splinecast::apps
