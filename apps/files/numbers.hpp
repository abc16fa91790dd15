#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Units of time in files. The value is the power of ten that converts the unit to nanoseconds.
enum class TimeUnit : int { nanoseconds = 0, microseconds = 3, milliseconds = 6, seconds = 9 };

/// `ns`, `us`, `ms` or `s`.
[[nodiscard]] std::optional<TimeUnit> parse_time_unit(std::string_view text) noexcept;

/// Converts a decimal number of `unit`s to nanoseconds, exactly: `1403636579.763555584` s loses no
/// digit. Rounds digits below the nanosecond to the nearest one, halves away from 0. Nothing for
/// any other text, and for a time that does not fit into 64 bits.
[[nodiscard]] std::optional<Time> parse_time(std::string_view text, TimeUnit unit) noexcept;

/// Reads a number, `nan` and `inf` included; nothing for any other text. Accepts a leading plus.
/// Values outside the range of double become 0 or infinity.
[[nodiscard]] std::optional<double> parse_number(std::string_view text) noexcept;

/// Reads a number, or a time that is not negative, at the beginning of a text, and removes it from
/// the text. Fast; returns false for blanks, quotes and a plus at the beginning, and for some rare
/// forms that parse_number() or parse_time() accept.
[[nodiscard]] bool take_number(std::string_view& text, double& value) noexcept;
[[nodiscard]] bool take_time(std::string_view& text, TimeUnit unit, Time& value) noexcept;

/// Reads an integer of at least 0; nothing for any other text.
[[nodiscard]] std::optional<std::uint64_t> parse_count(std::string_view text) noexcept;

/// Whether a character is a blank, which may surround a field.
[[nodiscard]] constexpr bool is_blank(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\r';
}

/// The text without surrounding blanks.
[[nodiscard]] constexpr std::string_view without_blanks(std::string_view text) noexcept {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// The text without surrounding blanks, and then without surrounding double quotes.
[[nodiscard]] constexpr std::string_view trimmed(std::string_view text) noexcept {
  text = without_blanks(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    text = text.substr(1, text.size() - 2);
  }
  return text;
}

}  // namespace splinecast::apps
