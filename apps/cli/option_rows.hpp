#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "apps/cli/command.hpp"
#include "apps/files/numbers.hpp"
#include "ipc/layout/options.hpp"
#include "splinecast/options.hpp"

/// Options on the command line from the rows of kCurveOptions and kStreamOptions: their names,
/// ranges, defaults and texts.
namespace splinecast::apps {

/// `--min-entry` for the key `min_entry`.
[[nodiscard]] std::string flag_of(std::string_view key);

/// The text of --help: what the option is, its values unless empty, and its default.
[[nodiscard]] std::string help_of(std::string_view meaning, std::string_view values,
                                  std::string_view initial);

/// Parse the value of a command line. Return nothing for a text that has another form.
void parse_option(const std::string& text, TimeUnit unit, std::optional<Time>& value);
void parse_option(const std::string& text, TimeUnit unit, std::optional<double>& value);
void parse_option(const std::string& text, TimeUnit unit, std::optional<std::size_t>& value);
void parse_option(const std::string& text, TimeUnit unit, std::optional<Tail>& value);
void parse_option(const std::string& text, TimeUnit unit, std::optional<Beyond>& value);

/// Throws UsageError: the text of an option is not `what`.
[[noreturn]] void refuse_option(std::string_view key, const std::string& text,
                                const std::string& what);

/// The value of an option in a text. Throws UsageError if it has another form, or is out of range.
template <typename Row>
[[nodiscard]] typename Row::Value row_value(const Row& row, const std::string& text,
                                            TimeUnit unit = TimeUnit::seconds) {
  std::optional<typename Row::Value> value;
  parse_option(text, unit, value);
  if (value && ipc::is_in_range(row, *value)) return *value;
  using Value = typename Row::Value;
  std::string what(row.range.text);
  if (std::is_same_v<Value, std::size_t>) {
    what = "an integer from " + ipc::value_text(row.range.least) + " to " +
           ipc::value_text(row.range.most);
  } else if (!std::is_enum_v<Value>) {
    what = "a number in the range " + what;
  }
  refuse_option(row.key, text, what);
}

/// Adds the option of a row, which must live as long as the command. A time is a number in `unit`,
/// which `type` names.
template <typename Row, typename Target>
Argument add_row(Command& verb, const Row& row, Target& value, const std::string& type,
                 TimeUnit unit = TimeUnit::seconds) {
  const auto take = [&row, &value, unit](const std::string& text) {
    value = row_value(row, text, unit);
  };
  // The type of an option of words lists them.
  const auto values = std::is_enum_v<typename Row::Value> ? std::string_view() : row.range.text;
  return verb.option(flag_of(row.key), take, help_of(row.meaning, values, row.initial)).type(type);
}

/// Add the option or the flag of a member of SolverOptions.
template <auto Option, typename Target>
Argument add_curve_option(Command& verb, Target& value, const std::string& type,
                          TimeUnit unit = TimeUnit::seconds) {
  return add_row(verb, ipc::option_of<Option>(), value, type, unit);
}
template <auto Option>
Argument add_curve_flag(Command& verb, bool& value) {
  constexpr const auto& kRow = ipc::option_of<Option>();
  return verb.flag(flag_of(kRow.key), value, std::string(kRow.meaning));
}

}  // namespace splinecast::apps
