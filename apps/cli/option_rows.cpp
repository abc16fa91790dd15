#include "apps/cli/option_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/cli/conditions.hpp"

namespace splinecast::apps {

std::string flag_of(std::string_view key) {
  std::string flag = "--" + std::string(key);
  std::ranges::replace(flag, '_', '-');
  return flag;
}

std::string help_of(std::string_view meaning, std::string_view values, std::string_view initial) {
  std::string help(meaning);
  if (!values.empty()) help += fmt::format("; {}", values);
  if (!initial.empty()) help += fmt::format(" ({})", initial);
  return help;
}

void parse_option(const std::string& text, TimeUnit unit, std::optional<Time>& value) {
  value = parse_time(text, unit);
}
void parse_option(const std::string& text, TimeUnit /*unit*/, std::optional<double>& value) {
  value = parse_number(text);
}
void parse_option(const std::string& text, TimeUnit /*unit*/, std::optional<std::size_t>& value) {
  value = parse_count(text);
}
void parse_option(const std::string& text, TimeUnit /*unit*/, std::optional<Tail>& value) {
  value = ipc::value_of_word<Tail>(present_word("--tail", text));
}
void parse_option(const std::string& text, TimeUnit /*unit*/, std::optional<Beyond>& value) {
  value = ipc::value_of_word<Beyond>(text);
}

void refuse_option(std::string_view key, const std::string& text, const std::string& what) {
  throw UsageError(flag_of(key), fmt::format("'{}' is not {}", text, what));
}

}  // namespace splinecast::apps
