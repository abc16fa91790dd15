#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "apps/files/lines.hpp"
#include "apps/files/text_file.hpp"

/// The file formats of tables of waypoints and times.
namespace splinecast::apps {

/// The format of the rows, from the beginning of a file.
struct TableFormat {
  Split split = split_at_commas;     ///< how a row is split into fields
  std::vector<std::string> names;    ///< of the columns
  std::vector<std::string> aliases;  ///< other names of the same columns, or none
  Line first_row;                    ///< number 0: there is no row
};

/// A file up to its first line that is neither blank nor a comment.
struct TableBeginning {
  const TextFile& file;
  std::vector<std::string_view> comments;  ///< without `#`, in order
  Line first;                              ///< that line
};

/// A table format. A constant of this type registers itself in the program's list before `main`
/// starts, so that a format is one source file, which no other file mentions. It must exist as long
/// as the program runs.
class InputFormat {
 public:
  /// Whether a file with this beginning has this format.
  using Fits = bool (*)(const TableBeginning& beginning);
  /// Determines the format of the rows. `lines` is after the first line, and on return after the
  /// first row. Throws InputError with file and line.
  using Read = TableFormat (*)(const TableBeginning& beginning, Lines& lines);

  /// Formats are tried in the order of their places. Each has a unique place below kLastPlace.
  InputFormat(int place, Fits fits, Read read) noexcept;
  static constexpr int kLastPlace = 100;  ///< of CSV, which accepts every file

  /// Reads the beginning of a table in the first format that fits. Throws InputError if there are
  /// no rows, and as `Read` does.
  [[nodiscard]] static TableFormat read_beginning(const TextFile& file, Lines& lines);

 private:
  int place_;
  Fits fits_;
  Read read_;
  const InputFormat* next_;  ///< in the list
};

/// The names in a line, without surrounding blanks and quotes.
[[nodiscard]] std::vector<std::string> column_names(std::string_view line, Split split);

}  // namespace splinecast::apps
