#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/files/input_file.hpp"
#include "apps/files/line_reader.hpp"
#include "apps/tables/format.hpp"

/// Formats of texts with one row in each line.
namespace splinecast::apps {

/// How the rows of a text are read.
struct TextFormat {
  Split split = split_at_commas;          ///< how a line is split into fields
  std::string_view separator = "commas";  ///< what separates them, for messages
  char separating = '\0';  ///< the character at which `split` splits outside of quotes; 0: several
  std::vector<std::string> names{};    ///< of the columns
  std::vector<std::string> aliases{};  ///< other names of the same columns, or none
  bool is_first_a_row = false;         ///< whether the first line is a row, and not the header
};

/// Reads the comments and the first line of a text.
void read_beginning(LineReader& lines, FileBeginning& beginning);

/// Determines the format from the beginning of a text. Throws InputError with file and line.
using ReadTextFormat = TextFormat (*)(const FileBeginning& beginning);

/// Opens a text. Throws InputError if it has no line, if `read` throws, or as ColumnRoles does.
[[nodiscard]] std::unique_ptr<RowReader> open_text(InputFile file, ReadTextFormat read,
                                                   const TableOptions& options);

/// The names in a line, without surrounding blanks and quotes.
[[nodiscard]] std::vector<std::string> column_names(std::string_view line, Split split);

}  // namespace splinecast::apps
