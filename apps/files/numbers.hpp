#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Units of time in files: the power of ten that makes one of them nanoseconds.
enum class TimeUnit : int { nanoseconds = 0, microseconds = 3, milliseconds = 6, seconds = 9 };

/// `ns`, `us`, `ms` or `s`.
[[nodiscard]] std::optional<TimeUnit> parse_time_unit(std::string_view text) noexcept;

/// Reads a decimal number of `unit`s as nanoseconds, exactly: `1403636579.763555584` seconds lose
/// nothing. Digits beyond the nanosecond round to the nearest one, halves away from 0. Nothing for
/// any other text or a time that 64 bits cannot hold.
[[nodiscard]] std::optional<Time> parse_time(std::string_view text, TimeUnit unit) noexcept;

/// Reads a number, `nan` and `inf` included; nothing for any other text. Accepts a leading plus.
/// What a double cannot hold becomes 0 or infinite.
[[nodiscard]] std::optional<double> parse_number(std::string_view text) noexcept;

/// Reads a whole number of 0 or more; nothing for any other text.
[[nodiscard]] std::optional<std::uint64_t> parse_count(std::string_view text) noexcept;

/// Whether a character is one that fields may have around them.
[[nodiscard]] constexpr bool is_blank(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\r';
}

/// Without the blanks around it.
[[nodiscard]] constexpr std::string_view without_blanks(std::string_view text) noexcept {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Without the blanks, and then the double quotes, around it.
[[nodiscard]] constexpr std::string_view trimmed(std::string_view text) noexcept {
  text = without_blanks(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    text = text.substr(1, text.size() - 2);
  }
  return text;
}

}  // namespace splinecast::apps
