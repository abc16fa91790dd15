#include "apps/tables/format.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/files/numbers.hpp"
#include "apps/process/exit_codes.hpp"

namespace splinecast::apps {
namespace {

/// The first format of the list. Constant-initialised: valid before any format is constructed.
constinit const InputFormat* first_format = nullptr;

TableBeginning beginning_of(const TextFile& file, Lines& lines) {
  TableBeginning beginning{.file = file, .comments = {}, .first = {}};
  while (lines.next(beginning.first)) {
    const std::string_view text = without_blanks(beginning.first.text);
    if (text.empty()) continue;
    if (text.front() != '#') return beginning;
    beginning.comments.push_back(without_blanks(text.substr(1)));
  }
  throw InputError(fmt::format("{}: there are no rows", file.name()));
}

}  // namespace

InputFormat::InputFormat(int place, Fits fits, Read read) noexcept
    : place_(place), fits_(fits), read_(read), next_(first_format) {
  first_format = this;
}

TableFormat InputFormat::read_beginning(const TextFile& file, Lines& lines) {
  const TableBeginning beginning = beginning_of(file, lines);
  const InputFormat* found = nullptr;
  for (const InputFormat* format = first_format; format != nullptr; format = format->next_) {
    const bool is_before = found == nullptr || format->place_ < found->place_;
    if (is_before && format->fits_(beginning)) found = format;
  }
  return found->read_(beginning, lines);  // never null: CSV accepts every file
}

std::vector<std::string> column_names(std::string_view line, Split split) {
  std::vector<std::string_view> fields;
  split(line, fields);
  std::vector<std::string> names;
  names.reserve(fields.size());
  for (const auto field : fields) names.emplace_back(trimmed(field));
  return names;
}

}  // namespace splinecast::apps
