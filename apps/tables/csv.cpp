#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "apps/files/numbers.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/tables/text_rows.hpp"
#include "apps/tables/time_column.hpp"

/// CSV with a header: the first line, or else the last comment before the first row that contains
/// the name of a time column. Fields are separated by commas, semicolons or tabs.
namespace splinecast::apps {
namespace {

struct Separator {
  Split split;
  std::string_view name;
  char character;
};
constexpr std::array<Separator, 3> kSeparators{{{split_at_commas, "commas", ','},
                                                {split_at_semicolons, "semicolons", ';'},
                                                {split_at_tabs, "tabs", '\t'}}};

bool names_a_time_column(std::string_view line, Split split) {
  return std::ranges::any_of(column_names(line, split), [](const std::string& name) {
    return unit_of_time_column(name).has_value();
  });
}

bool is_csv(const FileBeginning& beginning) { return beginning.is_text; }

/// The separator of a header: one that gives it a time column; else one that it contains; else the
/// comma.
const Separator& separator_of(std::string_view header) {
  const auto names_time = [&](const Separator& separator) {
    return names_a_time_column(header, separator.split);
  };
  const auto separates = [&](const Separator& separator) {
    return column_names(header, separator.split).size() > 1;
  };
  for (const Separator& separator : kSeparators) {
    if (separates(separator) && names_time(separator)) return separator;
  }
  const auto* const found = std::ranges::find_if(kSeparators, separates);
  return found == kSeparators.end() ? kSeparators[0] : *found;
}

TextFormat read_csv(const FileBeginning& beginning) {
  const Separator& first = separator_of(beginning.first);
  TextFormat format{.split = first.split,
                    .separator = first.name,
                    .separating = first.character,
                    .names = column_names(beginning.first, first.split)};
  if (!parse_number(format.names[0])) return format;
  const auto header = std::ranges::find_if(
      beginning.comments.rbegin(), beginning.comments.rend(),
      [&](const std::string& comment) { return names_a_time_column(comment, first.split); });
  if (header == beginning.comments.rend()) {
    throw InputError(fmt::format("{}:{}: there is no header before the first row", beginning.name,
                                 beginning.first_number));
  }
  format.names = column_names(*header, first.split);
  format.is_first_a_row = true;
  return format;
}

std::unique_ptr<RowReader> open_csv(InputFile file, const TableOptions& options) {
  return open_text(std::move(file), read_csv, options);
}

const InputFormat csv_format(InputFormat::kLastPlace, is_csv, open_csv);

}  // namespace
}  // namespace splinecast::apps
