#include "apps/files/lines.hpp"

#include "apps/files/numbers.hpp"

namespace splinecast::apps {
namespace {

/// The end of the first field of a line: a separator that is not within double quotes.
template <char kSeparator>
std::size_t end_of_field(std::string_view line) noexcept {
  const std::size_t first = line.find_first_not_of(kSeparator == '\t' ? " \r" : " \t\r");
  if (first == std::string_view::npos || line[first] != '"') return line.find(kSeparator);
  const std::size_t closing = line.find('"', first + 1);
  return closing == std::string_view::npos ? line.find(kSeparator) : line.find(kSeparator, closing);
}

template <char kSeparator>
void split_at(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (;;) {
    const std::size_t end = end_of_field<kSeparator>(line);
    fields.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
  }
}

}  // namespace

Lines::Lines(std::string_view text) : rest_(text) {
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

void split_at_commas(std::string_view line, std::vector<std::string_view>& fields) {
  split_at<','>(line, fields);
}

void split_at_semicolons(std::string_view line, std::vector<std::string_view>& fields) {
  split_at<';'>(line, fields);
}

void split_at_tabs(std::string_view line, std::vector<std::string_view>& fields) {
  split_at<'\t'>(line, fields);
}

void split_at_blanks(std::string_view line, std::vector<std::string_view>& fields) {
  constexpr std::string_view kBlanks = " \t";
  fields.clear();
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

}  // namespace splinecast::apps
