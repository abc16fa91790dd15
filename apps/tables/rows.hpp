#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/tables/options.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

/// Waypoints from a file of any format, one row after the other.
namespace splinecast::apps {

/// One row of a file. The views are valid until the next call of the reader.
struct Row {
  std::size_t number = 0;  ///< line of a text, or number of a message, from 1
  Time time{};
  std::span<const double> position{};      ///< one value per column
  std::span<const double> velocity{};      ///< the same, or empty if this row has none
  std::span<const double> acceleration{};  ///< the same, or empty if this row has none

  [[nodiscard]] Waypoint waypoint() const noexcept {
    return {.time = time, .position = position, .velocity = velocity, .acceleration = acceleration};
  }
};

/// What the rows of a text are called: see RowReader::row_name().
inline constexpr std::string_view kLineName = "line";

/// The position columns of a file.
struct RowColumns {
  std::vector<std::string> names{};    ///< with the unit in brackets, if it is known
  std::vector<std::string> aliases{};  ///< other names of the same columns, or none
  std::vector<Dimension> kinds{};      ///< if the format defines them; none: by names and options

  [[nodiscard]] std::size_t dimensions() const noexcept { return names.size(); }
};

/// Reads the rows of a file in their order, with memory for one row. One thread uses it.
class RowReader {
 public:
  RowReader() = default;
  RowReader(const RowReader&) = delete;
  RowReader& operator=(const RowReader&) = delete;
  virtual ~RowReader() = default;

  /// The file, for messages.
  [[nodiscard]] virtual const std::string& name() const = 0;
  [[nodiscard]] virtual const RowColumns& columns() const = 0;

  /// Reads the next row. Returns false at the end. Throws InputError, with file, line or message,
  /// column and value, for a row that cannot be read; `row.number` is set, and the next call reads
  /// the row after it. If the rest of the file cannot be read, throws InputError with `row.number`
  /// 0. Values may be not finite, and times need not increase.
  virtual bool next(Row& row) = 0;

  /// Goes back to the first row. From then on next() throws InputError if the file has changed
  /// since it was opened.
  virtual void rewind() = 0;

  /// Passes over rows, also those that cannot be read. A format may do this faster than next().
  virtual void skip(std::size_t rows);

  /// The place of a row, for messages: `file:12`, or `file.mcap: message 12 of /joint_states`.
  [[nodiscard]] virtual std::string where(std::size_t number) const = 0;

  /// What a row's number counts, for messages: `line` or `message`. A string literal.
  [[nodiscard]] virtual std::string_view row_name() const noexcept = 0;

  /// The part of the file that has been read, 0 to 1.
  [[nodiscard]] virtual double fraction_read() const = 0;
};

/// Opens a file, `-` for standard input, in the first format that fits. Reports on standard error
/// which columns are read as what, if this is not clear from their names. Throws InputError if the
/// file cannot be read.
[[nodiscard]] std::unique_ptr<RowReader> open_rows(const std::string& path,
                                                   const TableOptions& options);

/// The kinds of a reader's dimensions: see resolve_kinds().
[[nodiscard]] std::vector<Dimension> kinds_of(const RowReader& rows,
                                              const std::vector<KindOption>& asked);

}  // namespace splinecast::apps
