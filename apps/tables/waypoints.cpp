#include "apps/tables/waypoints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "apps/process/messages.hpp"
#include "apps/tables/kinds.hpp"

namespace splinecast::apps {
namespace {

/// Collects the rows of a reader.
class TableReader {
 public:
  TableReader(std::shared_ptr<RowReader> rows, const TableOptions& options)
      : rows_(std::move(rows)), options_(options) {
    table_.file = rows_->name();
    table_.names = rows_->columns().names;
    table_.source = rows_;
  }

  WaypointTable read() {
    table_.kinds = kinds_of(*rows_, options_.kinds);
    while (next()) {
      add();
      if (table_.size() == kFirstRows) reserve();
      if (table_.size() % kShownRows == 0) show_progress();
    }
    require_complete(table_.velocities, has_velocities_, "velocities");
    require_complete(table_.accelerations, has_accelerations_, "accelerations");
    if (table_.size() == 0) {
      throw InputError(fmt::format("{}: there are no waypoints", table_.file));
    }
    return std::move(table_);
  }

  std::vector<Time> read_times() {
    while (next()) table_.times.push_back(row_.time);
    return std::move(table_.times);
  }

 private:
  static constexpr std::size_t kFirstRows = 1024;
  static constexpr std::size_t kShownRows = 65'536;

  /// Reads the next row that can be read.
  bool next() {
    if (!options_.on_bad_row) return rows_->next(row_);
    for (;;) {
      try {
        return rows_->next(row_);
      } catch (const InputError& error) {
        if (row_.number == 0) throw;
        options_.on_bad_row(row_.number, error);
      }
    }
  }

  void add() {
    table_.times.push_back(row_.time);
    table_.lines.push_back(row_.number);
    append(row_.position, table_.positions);
    append(row_.velocity, table_.velocities);
    append(row_.acceleration, table_.accelerations);
    if (!row_.velocity.empty()) ++has_velocities_;
    if (!row_.acceleration.empty()) ++has_accelerations_;
  }
  static void append(std::span<const double> values, std::vector<double>& all) {
    all.insert(all.end(), values.begin(), values.end());
  }

  /// Reserves memory for the number of rows that the first ones let expect, up to a size from which
  /// reallocation is cheap in comparison with reading.
  void reserve() {
    constexpr std::size_t kMostRows = std::size_t{1} << 18U;
    const double expected =
        1.07 * static_cast<double>(kFirstRows) / std::max(rows_->fraction_read(), 1e-9);
    const std::size_t rows =
        static_cast<std::size_t>(std::min(expected, static_cast<double>(kMostRows)));
    table_.times.reserve(rows);
    table_.lines.reserve(rows);
    table_.positions.reserve(rows * table_.dimensions());
    for (auto* values : {&table_.velocities, &table_.accelerations}) {
      if (!values->empty()) values->reserve(rows * table_.dimensions());
    }
  }

  void show_progress() {
    progress_.show(fmt::format("{}: {:.0f} % read", table_.file, 100 * rows_->fraction_read()));
  }

  /// Drops a derivative that not all rows have.
  void require_complete(std::vector<double>& values, std::size_t rows, std::string_view what) {
    if (rows == table_.size() || rows == 0) return;
    values.clear();
    if (options_.quiet) return;
    say(fmt::format("{}: {} of {} rows have {}: they are left out", table_.file, rows,
                    table_.size(), what));
  }

  std::shared_ptr<RowReader> rows_;
  const TableOptions& options_;
  WaypointTable table_{};
  Row row_{};
  std::size_t has_velocities_ = 0;
  std::size_t has_accelerations_ = 0;
  Progress progress_;
};

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

std::string WaypointTable::where(std::size_t i) const {
  return source ? source->where(lines[i]) : fmt::format("{}:{}", file, lines[i]);
}

std::string_view WaypointTable::row_name() const noexcept {
  return source ? source->row_name() : kLineName;
}

std::vector<Dimension> kinds_of(const RowReader& rows, const std::vector<KindOption>& asked) {
  return resolve_kinds(rows.name(), rows.columns(), asked);
}

WaypointTable read_waypoints(const std::string& path, const TableOptions& options) {
  return TableReader(open_rows(path, options), options).read();
}

std::vector<Time> read_times(const std::string& path, TableOptions options) {
  options.only_times = true;
  return TableReader(open_rows(path, options), options).read_times();
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
    throw InputError(fmt::format("{}: time {} ns is not after {} ns, the time of {} {}",
                                 table.where(i), table.times[i].count(), table.times[i - 1].count(),
                                 table.row_name(), table.lines[i - 1]));
  }
}

}  // namespace splinecast::apps
