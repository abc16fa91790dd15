#include <fmt/format.h>

#include <array>

#include "apps/files/numbers.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/tables/format.hpp"

/// TUM text: `t x y z qx qy qz qw` in each row. If the last comment before the first row has eight
/// words, they are aliases of the columns.
namespace splinecast::apps {
namespace {

constexpr std::array<std::string_view, 8> kColumns{"t", "x", "y", "z", "qx", "qy", "qz", "qw"};

/// Whether the first line has fields separated by blanks, a number in the first one, and no comma.
bool is_tum(const TableBeginning& beginning) {
  const std::string_view text = without_blanks(beginning.first.text);
  return text.find(',') == std::string_view::npos &&
         text.find_first_of(" \t") != std::string_view::npos &&
         parse_number(column_names(text, split_at_blanks)[0]).has_value();
}

TableFormat read_tum(const TableBeginning& beginning, Lines& /*lines*/) {
  const Line& first = beginning.first;
  const std::size_t fields = column_names(first.text, split_at_blanks).size();
  if (fields != kColumns.size()) {
    throw InputError(fmt::format(
        "{}:{}: neither CSV (no comma, no header) nor TUM text (8 fields; this line has {})",
        beginning.file.name(), first.number, fields));
  }
  TableFormat format{.split = split_at_blanks,
                     .names = {kColumns.begin(), kColumns.end()},
                     .aliases = {},
                     .first_row = first};
  if (!beginning.comments.empty()) {
    format.aliases = column_names(beginning.comments.back(), split_at_blanks);
  }
  if (format.aliases.size() != format.names.size()) format.aliases.clear();
  return format;
}

const InputFormat tum_format(10, is_tum, read_tum);

}  // namespace
}  // namespace splinecast::apps
