#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/files/numbers.hpp"
#include "apps/files/text_file.hpp"

/// The forms that tables of waypoints and times come in, up to their first row.
namespace splinecast::apps {

/// One line of a file.
struct Line {
  std::size_t number = 0;  ///< from 1; 0: there is none
  std::string_view text;
};

/// Walks over the lines of a text; takes `\n` and `\r\n`, and a last line without either.
class Lines {
 public:
  explicit Lines(std::string_view text);
  bool next(Line& line);
  /// The next line that is neither blank nor a comment.
  bool next_data(Line& line);

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// Splits a line at commas, or at runs of blanks; the fields are views into the line.
void split(std::string_view line, bool at_commas, std::vector<std::string_view>& fields);

/// What a file's beginning says about its rows.
struct TableFormat {
  bool at_commas = true;
  std::vector<std::string> names;
  std::vector<std::string> aliases;  ///< other names of the same columns, or none
  Line first_row;                    ///< number 0: there is no row
};

/// Reads up to the first row: CSV with a header, also one behind `#`, or TUM text. `lines` then
/// stands behind that row. Throws InputError naming file and line.
[[nodiscard]] TableFormat read_format(const TextFile& file, Lines& lines);

/// The unit of a time column by its name, or nothing if the name is not one of a time column.
[[nodiscard]] std::optional<TimeUnit> unit_of_time_column(std::string_view name);

}  // namespace splinecast::apps
