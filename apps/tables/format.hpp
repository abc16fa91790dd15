#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "apps/files/lines.hpp"
#include "apps/files/text_file.hpp"

/// The formats that tables of waypoints and times come in.
namespace splinecast::apps {

/// What a file's beginning says about its rows.
struct TableFormat {
  Split split = split_at_commas;     ///< how a row is split into fields
  std::vector<std::string> names;    ///< of the columns
  std::vector<std::string> aliases;  ///< other names of the same columns, or none
  Line first_row;                    ///< number 0: there is no row
};

/// A file up to its first line that is neither blank nor a comment.
struct TableBeginning {
  const TextFile& file;
  std::vector<std::string_view> comments;  ///< without `#`, in their order
  Line first;                              ///< that line
};

/// A format of tables. A constant of this type enters itself into the program's list before `main`
/// begins, so that a format is one file: nothing else names it. Lives as long as the program.
class InputFormat {
 public:
  /// Whether a file that begins so is of this format.
  using Fits = bool (*)(const TableBeginning& beginning);
  /// Finds out what the rows are. `lines` is behind the first line, and then behind the first row.
  /// Throws InputError naming file and line.
  using Read = TableFormat (*)(const TableBeginning& beginning, Lines& lines);

  /// Formats are asked in the order of their places; each has one of its own, below kLastPlace.
  InputFormat(int place, Fits fits, Read read) noexcept;
  static constexpr int kLastPlace = 100;  ///< of CSV, which takes whatever no other format takes

  /// Reads a table's beginning, by the first format that fits. Throws InputError naming file and
  /// line if there are no rows, and as `Read` does.
  [[nodiscard]] static TableFormat read_beginning(const TextFile& file, Lines& lines);

 private:
  int place_;
  Fits fits_;
  Read read_;
  const InputFormat* next_;  ///< in the list
};

/// The names in a line, without the blanks around them.
[[nodiscard]] std::vector<std::string> column_names(std::string_view line, Split split);

}  // namespace splinecast::apps
