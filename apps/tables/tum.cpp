#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "apps/files/numbers.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/tables/text_rows.hpp"
#include "apps/tables/time_column.hpp"

/// TUM text: `t x y z qx qy qz qw` in each row. If the last comment before the first row has eight
/// words, they are aliases of the columns.
namespace splinecast::apps {
namespace {

constexpr std::array<std::string_view, 8> kColumns{"t", "x", "y", "z", "qx", "qy", "qz", "qw"};

/// Whether a comment is the header of fields separated by tabs: CSV.
bool is_header_with_tabs(const std::string& comment) {
  return comment.find('\t') != std::string::npos &&
         std::ranges::any_of(column_names(comment, split_at_tabs), [](const std::string& name) {
           return unit_of_time_column(name).has_value();
         });
}

/// Whether the first line has fields separated by blanks, a number in the first one, and no comma
/// or semicolon.
bool is_tum(const FileBeginning& beginning) {
  const std::string_view text = beginning.first;
  return text.find_first_of(",;") == std::string_view::npos &&
         text.find_first_of(" \t") != std::string_view::npos &&
         parse_number(column_names(text, split_at_blanks)[0]).has_value() &&
         std::ranges::none_of(beginning.comments, is_header_with_tabs);
}

TextFormat read_tum(const FileBeginning& beginning) {
  const std::size_t fields = column_names(beginning.first, split_at_blanks).size();
  if (fields != kColumns.size()) {
    throw InputError(fmt::format(
        "{}:{}: neither CSV (no comma, semicolon or header) nor TUM text (8 fields separated by "
        "blanks; this line has {})",
        beginning.name, beginning.first_number, fields));
  }
  TextFormat format{.split = split_at_blanks,
                    .separator = "blanks",
                    .names = {kColumns.begin(), kColumns.end()},
                    .aliases = {},
                    .is_first_a_row = true};
  if (!beginning.comments.empty()) {
    format.aliases = column_names(beginning.comments.back(), split_at_blanks);
  }
  if (format.aliases.size() != format.names.size()) format.aliases.clear();
  return format;
}

std::unique_ptr<RowReader> open_tum(InputFile file, const TableOptions& options) {
  return open_text(std::move(file), read_tum, options);
}

const InputFormat tum_format(10, is_tum, open_tum);

}  // namespace
}  // namespace splinecast::apps
