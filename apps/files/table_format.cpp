#include "apps/files/table_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "apps/process/exit_codes.hpp"

namespace splinecast::apps {
namespace {

constexpr std::array<std::string_view, 8> kTumColumns{"t", "x", "y", "z", "qx", "qy", "qz", "qw"};

std::vector<std::string> names_of(std::string_view line, bool at_commas) {
  std::vector<std::string_view> fields;
  split(line, at_commas, fields);
  std::vector<std::string> names;
  names.reserve(fields.size());
  for (const auto field : fields) names.emplace_back(trimmed(field));
  return names;
}

/// TUM text: t x y z qx qy qz qw; a comment with as many words gives the columns other names.
TableFormat tum_format(const TextFile& file, const Line& first, std::string_view comment) {
  TableFormat format{.at_commas = false,
                     .names = {kTumColumns.begin(), kTumColumns.end()},
                     .aliases = names_of(comment, false),
                     .first_row = first};
  if (format.aliases.size() != format.names.size()) format.aliases.clear();
  std::vector<std::string_view> fields;
  split(first.text, false, fields);
  if (fields.size() != kTumColumns.size()) {
    throw InputError(fmt::format(
        "{}:{}: neither CSV (no comma, no header) nor TUM text (8 fields; this line has {})",
        file.name(), first.number, fields.size()));
  }
  return format;
}

/// Where the first field of a CSV line ends: at a comma that is not within double quotes.
std::size_t end_of_field(std::string_view line) noexcept {
  const std::size_t first = line.find_first_not_of(" \t\r");
  if (first == std::string_view::npos || line[first] != '"') return line.find(',');
  const std::size_t closing = line.find('"', line.find('"') + 1);
  return closing == std::string_view::npos ? line.find(',') : line.find(',', closing);
}

bool names_a_time_column(std::string_view comment) {
  return std::ranges::any_of(names_of(comment, true), [](const std::string& name) {
    return unit_of_time_column(name).has_value();
  });
}

}  // namespace

Lines::Lines(std::string_view text) : rest_(text) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
}

bool Lines::next(Line& line) {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find('\n');
  line.text = rest_.substr(0, end);
  line.number = ++number_;
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (line.text.ends_with('\r')) line.text.remove_suffix(1);
  return true;
}

bool Lines::next_data(Line& line) {
  while (next(line)) {
    const std::string_view text = trimmed(line.text);
    if (!text.empty() && text.front() != '#') return true;
  }
  return false;
}

void split(std::string_view line, bool at_commas, std::vector<std::string_view>& fields) {
  fields.clear();
  if (at_commas) {
    for (;;) {
      const std::size_t comma = end_of_field(line);
      fields.push_back(line.substr(0, comma));
      if (comma == std::string_view::npos) return;
      line.remove_prefix(comma + 1);
    }
  }
  constexpr std::string_view kBlanks = " \t";
  for (;;) {
    const std::size_t begin = line.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return;
    line.remove_prefix(begin);
    const std::size_t end = line.find_first_of(kBlanks);
    fields.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end);
  }
}

TableFormat read_format(const TextFile& file, Lines& lines) {
  Line line;
  bool found = false;
  std::string_view header;   // the last comment that could be a CSV's header
  std::string_view comment;  // the last comment
  while (!found && lines.next(line)) {
    const std::string_view text = without_blanks(line.text);
    if (text.empty()) continue;
    found = text.front() != '#';
    if (found) break;
    comment = without_blanks(text.substr(1));
    if (names_a_time_column(comment)) header = comment;
  }
  if (!found) throw InputError(fmt::format("{}: there are no rows", file.name()));
  const std::string_view text = without_blanks(line.text);
  const bool has_comma = text.find(',') != std::string_view::npos;
  const bool starts_with_number = parse_number(names_of(text, has_comma)[0]).has_value();
  const bool has_blanks = text.find_first_of(" \t") != std::string_view::npos;
  if (!has_comma && starts_with_number && has_blanks) return tum_format(file, line, comment);
  TableFormat format;
  if (!starts_with_number) {
    format.names = names_of(text, true);
    if (!lines.next_data(format.first_row)) format.first_row = {};
  } else {
    format.names = names_of(header, true);
    format.first_row = line;
    if (header.empty()) {
      throw InputError(
          fmt::format("{}:{}: there is no header before the first row", file.name(), line.number));
    }
  }
  return format;
}

std::optional<TimeUnit> unit_of_time_column(std::string_view name) {
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::string_view rest = lower;
  for (const std::string_view base : {"timestamp", "time", "t"}) {
    if (!rest.starts_with(base)) continue;
    rest.remove_prefix(base.size());
    if (rest.empty()) return TimeUnit::seconds;
    if (rest.front() == '_') return parse_time_unit(rest.substr(1));
    rest = trimmed(rest);
    const bool bracketed = (rest.starts_with('[') && rest.ends_with(']')) ||
                           (rest.starts_with('(') && rest.ends_with(')'));
    return bracketed ? parse_time_unit(rest.substr(1, rest.size() - 2)) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace splinecast::apps
