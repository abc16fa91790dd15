#include <fmt/format.h>

#include <algorithm>

#include "apps/files/numbers.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/tables/format.hpp"
#include "apps/tables/time_column.hpp"

/// CSV with a header: the first line, or else the last comment before the first row that contains
/// the name of a time column.
namespace splinecast::apps {
namespace {

bool names_a_time_column(std::string_view comment) {
  return std::ranges::any_of(column_names(comment, split_at_commas), [](const std::string& name) {
    return unit_of_time_column(name).has_value();
  });
}

bool is_csv(const TableBeginning& /*beginning*/) { return true; }

TableFormat read_csv(const TableBeginning& beginning, Lines& lines) {
  TableFormat format;
  const Line& first = beginning.first;
  const std::vector<std::string> names = column_names(without_blanks(first.text), split_at_commas);
  if (!parse_number(names[0])) {
    format.names = names;
    if (!lines.next_data(format.first_row)) format.first_row = {};
    return format;
  }
  const auto header = std::ranges::find_if(beginning.comments.rbegin(), beginning.comments.rend(),
                                           names_a_time_column);
  if (header == beginning.comments.rend()) {
    throw InputError(fmt::format("{}:{}: there is no header before the first row",
                                 beginning.file.name(), first.number));
  }
  format.names = column_names(*header, split_at_commas);
  format.first_row = first;
  return format;
}

const InputFormat csv_format(InputFormat::kLastPlace, is_csv, read_csv);

}  // namespace
}  // namespace splinecast::apps
