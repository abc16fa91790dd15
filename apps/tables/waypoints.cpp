#include "apps/tables/waypoints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "apps/files/text_file.hpp"
#include "apps/tables/column_roles.hpp"
#include "apps/tables/format.hpp"
#include "apps/tables/kinds.hpp"

namespace splinecast::apps {
namespace {

/// Reads the rows of a waypoint file.
class TableReader {
 public:
  TableReader(const std::string& path, std::optional<TimeUnit> time_unit)
      : file_(path),
        lines_(file_.text()),
        format_(InputFormat::read_beginning(file_, lines_)),
        columns_(file_.name(), format_, time_unit) {}
  TableReader(const TableReader&) = delete;
  TableReader& operator=(const TableReader&) = delete;
  ~TableReader() = default;

  [[nodiscard]] const std::string& name() const { return file_.name(); }
  [[nodiscard]] const Roles& roles() const { return columns_.roles(); }
  [[nodiscard]] std::vector<std::string> position_names() const {
    std::vector<std::string> names;
    for (const std::size_t field : roles().positions) names.push_back(format_.names[field]);
    return names;
  }

  /// The kinds of the position columns.
  [[nodiscard]] std::vector<Dimension> kinds(const std::vector<KindOption>& asked) const {
    std::vector<std::string> aliases;
    for (const std::size_t field : roles().positions) {
      if (!format_.aliases.empty()) aliases.push_back(format_.aliases[field]);
    }
    return resolve_kinds(name(), {.names = position_names(), .aliases = aliases}, asked);
  }

  /// Finds the columns of positions and given derivatives.
  void find_values(const std::vector<std::string>& selected) {
    columns_.find_values(selected, lines_);
  }

  /// Reads the fields of the next row. Returns false at the end.
  bool next(std::vector<std::string_view>& fields) {
    if (!started_) {
      started_ = true;
      line_ = format_.first_row;
      if (line_.number == 0) return false;
    } else if (!lines_.next_data(line_)) {
      return false;
    }
    format_.split(line_.text, fields);
    return true;
  }
  void require_width(const std::vector<std::string_view>& fields) const {
    if (fields.size() == format_.names.size()) return;
    throw InputError(fmt::format("{}:{}:1: {} fields, but there are {} columns", name(),
                                 line_.number, fields.size(), format_.names.size()));
  }

  [[nodiscard]] std::size_t line() const { return line_.number; }

  /// Estimated number of rows, if all are as long as the first one, plus a sixteenth.
  [[nodiscard]] std::size_t rows_expected() const {
    if (format_.first_row.number == 0) return 0;
    const std::size_t length = std::max(format_.first_row.text.size(), 2 * format_.names.size());
    return file_.text().size() / (length + 1) + file_.text().size() / 16 / (length + 1) + 1;
  }

  [[nodiscard]] Time time(const std::vector<std::string_view>& fields) const {
    const auto time = parse_time(fields[roles().time], roles().unit);
    if (!time) fail(fields[roles().time], roles().time, "is not a time");
    if (!is_time_in_range(*time)) {
      fail(fields[roles().time], roles().time, "is not within ±(2^62 − 1) ns, about 146 years");
    }
    return *time;
  }
  [[nodiscard]] double number(const std::vector<std::string_view>& fields,
                              std::size_t column) const {
    const auto value = parse_number(fields[column]);
    if (!value) fail(fields[column], column, "is not a number");
    return *value;
  }

 private:
  [[noreturn]] void fail(std::string_view field, std::size_t column_at, const char* what) const {
    throw InputError(fmt::format("{}:{}:{}: column '{}': '{}' {}", name(), line_.number,
                                 field.data() - line_.text.data() + 1, format_.names[column_at],
                                 trimmed(field), what));
  }

  TextFile file_;
  Lines lines_;
  TableFormat format_;
  ColumnRoles columns_;
  Line line_;
  bool started_ = false;
};

/// Appends the numbers of a row in the given columns.
void append_numbers(const TableReader& reader, const std::vector<std::string_view>& fields,
                    const std::vector<std::size_t>& columns, std::vector<double>& values) {
  for (const std::size_t column : columns) values.push_back(reader.number(fields, column));
}

void append_row(const TableReader& reader, const std::vector<std::string_view>& fields,
                WaypointTable& table) {
  reader.require_width(fields);
  const Time time = reader.time(fields);
  const Roles& roles = reader.roles();
  append_numbers(reader, fields, roles.positions, table.positions);
  append_numbers(reader, fields, roles.velocities, table.velocities);
  append_numbers(reader, fields, roles.accelerations, table.accelerations);
  table.times.push_back(time);
  table.lines.push_back(reader.line());
}

/// Removes the values of an incomplete row.
void drop_unfinished_row(const Roles& roles, WaypointTable& table) {
  table.positions.resize(table.size() * roles.positions.size());
  table.velocities.resize(table.size() * roles.velocities.size());
  table.accelerations.resize(table.size() * roles.accelerations.size());
}

/// Reserves memory for the expected number of rows, up to a size from which reallocation is cheap
/// in comparison with reading.
void reserve(const TableReader& reader, WaypointTable& table) {
  constexpr std::size_t kMostRows = std::size_t{1} << 18U;
  const std::size_t rows = std::min(reader.rows_expected(), kMostRows);
  const Roles& roles = reader.roles();
  table.times.reserve(rows);
  table.lines.reserve(rows);
  table.positions.reserve(rows * roles.positions.size());
  table.velocities.reserve(rows * roles.velocities.size());
  table.accelerations.reserve(rows * roles.accelerations.size());
}

std::span<const double> row_of(const std::vector<double>& values, std::size_t i,
                               std::size_t dimensions) noexcept {
  return values.empty() ? std::span<const double>{}
                        : std::span(values).subspan(i * dimensions, dimensions);
}

}  // namespace

Waypoint WaypointTable::waypoint(std::size_t i) const noexcept {
  return {.time = times[i],
          .position = row_of(positions, i, dimensions()),
          .velocity = row_of(velocities, i, dimensions()),
          .acceleration = row_of(accelerations, i, dimensions())};
}

void WaypointTable::keep_rows(const std::function<bool(std::size_t i)>& keeps) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    if (!keeps(i)) continue;
    if (kept != i) {
      times[kept] = times[i];
      lines[kept] = lines[i];
      for (auto* values : {&positions, &velocities, &accelerations}) {
        std::ranges::copy(row_of(*values, i, dimensions()),
                          values->begin() + static_cast<std::ptrdiff_t>(kept * dimensions()));
      }
    }
    ++kept;
  }
  times.resize(kept);
  lines.resize(kept);
  for (auto* values : {&positions, &velocities, &accelerations}) {
    if (!values->empty()) values->resize(kept * dimensions());
  }
}

std::string WaypointTable::where(std::size_t i) const {
  return fmt::format("{}:{}", file, lines[i]);
}

WaypointTable read_waypoints(const std::string& path, const TableOptions& options) {
  TableReader reader(path, options.time_unit);
  reader.find_values(options.columns);
  WaypointTable table;
  table.file = reader.name();
  table.names = reader.position_names();
  table.kinds = reader.kinds(options.kinds);
  reserve(reader, table);
  std::vector<std::string_view> fields;
  while (reader.next(fields)) {
    try {
      append_row(reader, fields, table);
    } catch (const InputError& error) {
      if (!options.on_bad_row) throw;
      drop_unfinished_row(reader.roles(), table);
      options.on_bad_row(reader.line(), error);
    }
  }
  if (table.size() == 0) throw InputError(fmt::format("{}: there are no waypoints", table.file));
  return table;
}

std::vector<Time> read_times(const std::string& path, std::optional<TimeUnit> time_unit) {
  TableReader reader(path, time_unit);
  std::vector<Time> times;
  std::vector<std::string_view> fields;
  while (reader.next(fields)) {
    reader.require_width(fields);
    times.push_back(reader.time(fields));
  }
  return times;
}

void require_spline_input(const WaypointTable& table) {
  const std::size_t dimensions = table.dimensions();
  for (std::size_t i = 0; i < table.size(); ++i) {
    for (std::size_t d = 0; d < dimensions; ++d) {
      const double value = table.positions[i * dimensions + d];
      if (is_usable(value)) continue;
      throw InputError(fmt::format("{}: column '{}': {} is not finite, or beyond 1e100",
                                   table.where(i), table.names[d], value));
    }
    if (i == 0 || table.times[i] > table.times[i - 1]) continue;
    throw InputError(fmt::format("{}: time {} ns is not after {} ns on line {}", table.where(i),
                                 table.times[i].count(), table.times[i - 1].count(),
                                 table.lines[i - 1]));
  }
}

}  // namespace splinecast::apps
