#include "support/waypoint_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <set>
#include <string_view>
#include <utility>

#include "splinecast/core/state.hpp"
#include "splinecast/ipc/waypoint_ring.hpp"
#include "support/kinds.hpp"
#include "support/table_format.hpp"
#include "support/text_file.hpp"

namespace splinecast::apps {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

std::string column_list(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

/// i of a column named `<word>[i]`, else kNone.
std::size_t index_of(std::string_view name, std::string_view word) {
  if (!name.starts_with(word) || !name.ends_with(']')) return kNone;
  name.remove_prefix(word.size());
  if (name.size() < 3 || name[0] != '[') return kNone;
  std::size_t index = 0;
  const char* const end = name.data() + name.size() - 1;
  const auto [last, error] = std::from_chars(name.data() + 1, end, index);
  return error == std::errc{} && last == end ? index : kNone;
}

std::size_t find(const std::vector<std::string>& names, std::string_view name) {
  const auto at = std::ranges::find(names, name);
  return at == names.end() ? kNone : static_cast<std::size_t>(at - names.begin());
}

/// Which field of a row is what.
struct Roles {
  std::size_t time = kNone;
  TimeUnit unit = TimeUnit::seconds;
  std::vector<std::size_t> positions;
  std::vector<std::size_t> velocities;
  std::vector<std::size_t> accelerations;
};

/// A waypoint file with its format known, ready to give its rows.
class TableReader {
 public:
  TableReader(const std::string& path, std::optional<TimeUnit> time_unit)
      : file_(path), lines_(file_.text()), format_(read_format(file_, lines_)) {
    find_time(time_unit);
  }

  [[nodiscard]] const std::string& name() const { return file_.name(); }
  [[nodiscard]] const Roles& roles() const { return roles_; }
  [[nodiscard]] std::vector<std::string> position_names() const {
    std::vector<std::string> names;
    for (const std::size_t field : roles_.positions) names.push_back(format_.names[field]);
    return names;
  }

  /// The kinds of the position columns.
  [[nodiscard]] std::vector<core::Dimension> kinds(const std::vector<KindOption>& asked) const {
    std::vector<std::string> aliases;
    for (const std::size_t field : roles_.positions) {
      if (!format_.aliases.empty()) aliases.push_back(format_.aliases[field]);
    }
    return resolve_kinds(name(), {.names = position_names(), .aliases = aliases}, asked);
  }

  /// Finds out which columns hold positions and given derivatives.
  void find_values(const std::vector<std::string>& selected) {
    const std::vector<std::size_t> all = position_columns();
    if (selected.empty()) {
      roles_.positions = all;
    } else {
      for (const std::string& wanted : selected) {
        const std::size_t c = column(wanted);
        if (c == roles_.time || std::ranges::find(roles_.positions, c) != roles_.positions.end()) {
          throw InputError(fmt::format("{}: column '{}' is {}", name(), wanted,
                                       c == roles_.time ? "the time" : "selected twice"));
        }
        roles_.positions.push_back(c);
      }
    }
    if (roles_.positions.empty()) {
      throw InputError(fmt::format("{}: there is no position column besides the time ({})", name(),
                                   column_list(format_.names)));
    }
    if (roles_.positions.size() > core::kMaxDimensions) {
      throw InputError(fmt::format("{}: {} position columns; at most {} dimensions are possible",
                                   name(), roles_.positions.size(), core::kMaxDimensions));
    }
    roles_.velocities = derivative_columns("v", all);
    roles_.accelerations = derivative_columns("a", all);
  }

  /// The fields of the next row, or false at the end. Throws for a row of another width.
  bool next(std::vector<std::string_view>& fields) {
    if (!started_) {
      started_ = true;
      line_ = format_.first_row;
      if (line_.number == 0) return false;
    } else if (!lines_.next_data(line_)) {
      return false;
    }
    split(line_.text, format_.at_commas, fields);
    return true;
  }
  void require_width(const std::vector<std::string_view>& fields) const {
    if (fields.size() == format_.names.size()) return;
    throw InputError(fmt::format("{}:{}:1: {} fields, but there are {} columns", name(),
                                 line_.number, fields.size(), format_.names.size()));
  }

  [[nodiscard]] std::size_t line() const { return line_.number; }

  /// How many rows there are if all are as long as the first one, and a few more.
  [[nodiscard]] std::size_t rows_expected() const {
    if (format_.first_row.number == 0) return 0;
    const std::size_t length = std::max(format_.first_row.text.size(), 2 * format_.names.size());
    return file_.text().size() / (length + 1) + file_.text().size() / 16 / (length + 1) + 1;
  }

  [[nodiscard]] core::Time time(const std::vector<std::string_view>& fields) const {
    const auto time = parse_time(fields[roles_.time], roles_.unit);
    if (!time) fail(fields[roles_.time], roles_.time, "is not a time");
    if (!ipc::is_time_in_range(*time)) {
      fail(fields[roles_.time], roles_.time, "lies beyond ±(2^62 − 1) ns, about 146 years");
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
  void find_time(std::optional<TimeUnit> time_unit) {
    std::set<std::string> seen;
    for (std::size_t c = 0; c < format_.names.size(); ++c) {
      const std::string& column_name = format_.names[c];
      if (!column_name.empty() && !seen.insert(column_name).second) {
        throw InputError(fmt::format("{}: two columns are named '{}'", name(), column_name));
      }
      const auto unit = unit_of_time_column(column_name);
      if (!unit || roles_.time != kNone) continue;
      roles_.time = c;
      roles_.unit = time_unit.value_or(*unit);
    }
    if (roles_.time == kNone) {
      throw InputError(fmt::format(
          "{}: there is no time column (t_ns, timestamp_us, timestamp [ns], t, time, timestamp) "
          "among {}{}",
          name(), column_list(format_.names),
          format_.names.size() == 1 ? " (fields are separated by commas)" : ""));
    }
  }

  /// A column by name, or by the name that a comment gives it.
  [[nodiscard]] std::size_t column(const std::string& wanted) const {
    std::size_t c = find(format_.names, wanted);
    if (c == kNone) c = find(format_.aliases, wanted);
    if (c == kNone) {
      throw InputError(fmt::format("{}: there is no column '{}' among {}", name(), wanted,
                                   column_list(format_.names)));
    }
    return c;
  }

  /// Columns that hold positions if none are selected: numeric ones that are nothing else.
  [[nodiscard]] std::vector<std::size_t> position_columns() const {
    std::vector<std::size_t> columns;
    for (std::size_t c = 0; c < format_.names.size(); ++c) {
      const std::string& column_name = format_.names[c];
      if (c == roles_.time || index_of(column_name, "v") != kNone ||
          index_of(column_name, "a") != kNone || is_sampled(column_name)) {
        continue;
      }
      if (is_numeric(c)) {
        columns.push_back(c);
      } else if (!column_name.empty()) {
        fmt::print(stderr, "splinecast: {}: column '{}' is not numeric and is left out\n", name(),
                   column_name);
      }
    }
    return columns;
  }

  /// Whether a column holds numbers: its first cell does, or, if that is bad, any other. (A bad
  /// cell must not make a dimension vanish.)
  [[nodiscard]] bool is_numeric(std::size_t c) const {
    Lines rest = lines_;
    Line line = format_.first_row;
    if (line.number == 0) return true;
    std::vector<std::string_view> fields;
    do {
      split(line.text, format_.at_commas, fields);
      if (c < fields.size() && parse_number(fields[c])) return true;
    } while (rest.next_data(line));
    return false;
  }

  /// j[i] beside p[i], v[i] and a[i], omega[i] and alpha[i] behind j[0]: samples that this program
  /// wrote, whose jerk and angular motion are no positions.
  [[nodiscard]] bool is_sampled(const std::string& column_name) const {
    const bool is_angular =
        index_of(column_name, "omega") != kNone || index_of(column_name, "alpha") != kNone;
    const std::size_t i = is_angular ? 0 : index_of(column_name, "j");
    if (i == kNone) return false;
    return std::ranges::all_of(std::string_view("pvaj"), [&](char letter) {
      return find(format_.names, fmt::format("{}[{}]", letter, i)) != kNone;
    });
  }

  /// Columns of a given derivative, one per selected position, or none at all. `<letter>[i]` goes
  /// with the column p[i] if there is one, else with the file's i-th position column.
  [[nodiscard]] std::vector<std::size_t> derivative_columns(
      std::string_view letter, const std::vector<std::size_t>& all) const {
    std::vector<std::size_t> columns;
    for (const std::size_t position : roles_.positions) {
      std::size_t i = index_of(format_.names[position], "p");
      if (i == kNone) {
        i = static_cast<std::size_t>(std::ranges::find(all, position) - all.begin());
      }
      const std::size_t c = find(format_.names, fmt::format("{}[{}]", letter, i));
      if (c != kNone && std::ranges::find(roles_.positions, c) == roles_.positions.end()) {
        columns.push_back(c);
      }
    }
    if (!columns.empty() && columns.size() != roles_.positions.size()) {
      throw InputError(fmt::format("{}: {} columns {}[i] for {} positions; one each, or none",
                                   name(), columns.size(), letter, roles_.positions.size()));
    }
    return columns;
  }

  [[noreturn]] void fail(std::string_view field, std::size_t column_at, const char* what) const {
    throw InputError(fmt::format("{}:{}:{}: column '{}': '{}' {}", name(), line_.number,
                                 field.data() - line_.text.data() + 1, format_.names[column_at],
                                 trimmed(field), what));
  }

  TextFile file_;
  Lines lines_;
  TableFormat format_;
  Roles roles_;
  Line line_;
  bool started_ = false;
};

/// Appends a row's numbers in some columns.
void append_numbers(const TableReader& reader, const std::vector<std::string_view>& fields,
                    const std::vector<std::size_t>& columns, std::vector<double>& values) {
  for (const std::size_t column : columns) values.push_back(reader.number(fields, column));
}

void append_row(const TableReader& reader, const std::vector<std::string_view>& fields,
                WaypointTable& table) {
  reader.require_width(fields);
  const core::Time time = reader.time(fields);
  const Roles& roles = reader.roles();
  append_numbers(reader, fields, roles.positions, table.positions);
  append_numbers(reader, fields, roles.velocities, table.velocities);
  append_numbers(reader, fields, roles.accelerations, table.accelerations);
  table.times.push_back(time);
  table.lines.push_back(reader.line());
}

/// Drops what stands of a row that was not read to its end.
void drop_unfinished_row(const Roles& roles, WaypointTable& table) {
  table.positions.resize(table.size() * roles.positions.size());
  table.velocities.resize(table.size() * roles.velocities.size());
  table.accelerations.resize(table.size() * roles.accelerations.size());
}

/// Room for as many rows as there will be if they are about as long as the first one, up to a
/// size from which growing costs little beside them.
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

core::Waypoint WaypointTable::waypoint(std::size_t i) const noexcept {
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

std::vector<core::Time> read_times(const std::string& path, std::optional<TimeUnit> time_unit) {
  TableReader reader(path, time_unit);
  std::vector<core::Time> times;
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
      if (core::is_usable(value)) continue;
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
