#include "apps/messages/json_path.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/messages/message_error.hpp"
#include "apps/process/exit_codes.hpp"

namespace splinecast::apps {
namespace {

constexpr std::size_t kMostSteps = 32;
constexpr std::string_view kQuote = "[\"";
constexpr std::string_view kQuoteEnd = "\"]";

[[noreturn]] void refuse(std::string_view text) {
  throw InputError(
      fmt::format("'{}' is not the path of a field, such as pose.position.x or joints[0]", text));
}

/// Removes the first step from the rest of a path and returns it.
std::string take_step(std::string_view& rest, bool is_first, std::string_view text) {
  if (rest.starts_with(kQuote)) {
    const std::size_t end = rest.find(kQuoteEnd, kQuote.size());
    if (end == std::string_view::npos) refuse(text);
    const std::string step(rest.substr(kQuote.size(), end - kQuote.size()));
    rest.remove_prefix(end + kQuoteEnd.size());
    return step;
  }
  const bool is_index = rest.front() == '[';
  if (!is_index && !is_first) {
    if (rest.front() != '.') refuse(text);
    rest.remove_prefix(1);
  }
  if (is_index) rest.remove_prefix(1);
  const std::size_t end =
      is_index ? rest.find(']') : std::min(rest.find_first_of(".["), rest.size());
  if (end == std::string_view::npos || end == 0) refuse(text);
  const std::string step(rest.substr(0, end));
  if (is_index && step.find_first_not_of("0123456789") != std::string::npos) refuse(text);
  rest.remove_prefix(is_index ? end + 1 : end);
  return step;
}

using nlohmann::ordered_json;

void add_paths(const ordered_json& value, JsonPath& path, std::vector<JsonPath>& paths) {
  if (value.is_number() && !path.empty()) paths.push_back(path);
  if (!value.is_structured() || path.size() == kMostSteps) return;
  for (const auto& [key, member] : value.items()) {
    path.push_back(key);
    add_paths(member, path, paths);
    path.pop_back();
  }
}

}  // namespace

JsonPath parse_json_path(std::string_view text) {
  JsonPath path;
  std::string_view rest = text;
  if (rest.empty()) refuse(text);
  while (!rest.empty()) {
    if (path.size() == kMostSteps) refuse(text);
    path.push_back(take_step(rest, path.empty(), text));
  }
  return path;
}

std::string to_string(const JsonPath& path) {
  std::string text;
  for (const std::string& step : path) {
    const bool is_plain = !step.empty() && step.find_first_of(".[]\"") == std::string::npos;
    const bool is_index = step.find_first_not_of("0123456789") == std::string::npos;
    if (!is_plain) {
      text += fmt::format("{}{}{}", kQuote, step, kQuoteEnd);
    } else if (is_index && !text.empty()) {
      text += fmt::format("[{}]", step);
    } else {
      text += (text.empty() ? "" : ".") + step;
    }
  }
  return text;
}

std::vector<JsonPath> paths_of_numbers(std::string_view message) {
  if (message.size() > kLongestJson) throw MessageError("longer than 1 MiB");
  const ordered_json root = ordered_json::parse(message, nullptr, false);
  if (root.is_discarded()) throw MessageError("not JSON");
  JsonPath path;
  std::vector<JsonPath> paths;
  add_paths(root, path, paths);
  return paths;
}

}  // namespace splinecast::apps
