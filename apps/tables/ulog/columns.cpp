#include "apps/tables/ulog/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/topics/decoder.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {
namespace {

using ulog::Field;
using ulog::FieldType;

std::string names_of(const std::vector<Field>& fields) {
  constexpr std::size_t kMost = 100;
  std::string text;
  for (std::size_t i = 0; i < std::min(fields.size(), kMost); ++i) {
    text += (text.empty() ? "" : ", ") + fields[i].path;
  }
  const std::size_t more = fields.size() - std::min(fields.size(), kMost);
  return more == 0 ? text : fmt::format("{} and {} more", text, more);
}

bool is_floating(const Field& field) {
  return field.type == FieldType::float32 || field.type == FieldType::float64;
}

/// Whether a name chooses a field: its own, that of its array, or that of a format around it.
bool chooses(std::string_view name, std::string_view path) {
  if (!path.starts_with(name)) return false;
  const std::string_view rest = path.substr(name.size());
  return rest.empty() || rest.front() == '[' || rest.front() == '.';
}

/// The array of an element: `q` of `q[3]`.
std::string_view array_of(const Field& field) {
  const std::string_view path = field.path;
  return path.ends_with(']') ? path.substr(0, path.rfind('[')) : std::string_view{};
}

bool is_quaternion(std::span<const Field> four) {
  const std::string_view array = array_of(four[0]);
  const std::string_view last = array.substr(array.rfind('.') + 1);
  if (last != "q" && !last.starts_with("q_")) return false;
  for (std::size_t k = 0; k < four.size(); ++k) {
    if (four[k].path != fmt::format("{}[{}]", array, k)) return false;
  }
  return true;
}

void set_kinds(UlogColumns& columns) {
  auto& kinds = columns.columns.kinds;
  kinds.resize(columns.fields.size());
  for (std::size_t d = 0; d + kQuaternionSize <= kinds.size(); ++d) {
    if (!is_quaternion(std::span(columns.fields).subspan(d, kQuaternionSize))) continue;
    std::ranges::fill(std::span(kinds).subspan(d, kQuaternionSize),
                      Dimension{.kind = DimensionKind::quaternion_wxyz});
  }
}

void set_time(UlogColumns& columns, const std::vector<Field>& fields, const std::string& where,
              const TableOptions& options) {
  const std::string name = options.time_column.empty() ? "timestamp" : options.time_column;
  const auto found = std::ranges::find(fields, name, &Field::path);
  if (found == fields.end() || is_floating(*found)) {
    throw InputError(fmt::format("{}: there is no integer field '{}' for the time among {}", where,
                                 shown(name), names_of(fields)));
  }
  columns.time = *found;
  columns.unit = options.time_unit.value_or(TimeUnit::microseconds);
}

}  // namespace

std::optional<Time> UlogColumns::time_of(std::span<const std::byte> sample) const {
  constexpr double kMostExact = 0x1p53;
  const double count = value_of(time, sample);
  const double scaled = count * std::pow(10.0, static_cast<int>(unit));
  if (std::abs(count) > kMostExact || std::abs(scaled) >= 0x1p62) return std::nullopt;
  std::int64_t nanoseconds = static_cast<std::int64_t>(count);
  for (int power = static_cast<int>(unit); power > 0; --power) nanoseconds *= 10;
  return Time(nanoseconds);
}

UlogColumns ulog_columns(const std::vector<Field>& fields, const std::string& where,
                         const TableOptions& options) {
  UlogColumns columns;
  set_time(columns, fields, where, options);
  const std::vector<std::string> names = chosen_names(options);
  for (const std::string& name : names) {
    const std::size_t before = columns.fields.size();
    std::ranges::copy_if(fields, std::back_inserter(columns.fields),
                         [&](const Field& field) { return chooses(name, field.path); });
    if (columns.fields.size() == before) {
      throw InputError(
          fmt::format("{}: there is no field '{}' among {}", where, shown(name), names_of(fields)));
    }
  }
  if (names.empty()) {
    std::ranges::copy_if(fields, std::back_inserter(columns.fields), is_floating);
  }
  if (columns.fields.empty() || columns.fields.size() > kMaxDimensions) {
    throw InputError(fmt::format("{}: {} columns: choose 1 to {} of the fields with --field: {}",
                                 where, columns.fields.size(), kMaxDimensions, names_of(fields)));
  }
  for (const Field& field : columns.fields) columns.columns.names.push_back(field.path);
  set_kinds(columns);
  columns.bytes = ulog::Formats::size(fields);
  return columns;
}

}  // namespace splinecast::apps
