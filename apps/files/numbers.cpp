#include "apps/files/numbers.hpp"

#include <fast_float/fast_float.h>

#include <charconv>
#include <cstdint>

namespace splinecast::apps {
namespace {

bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

/// The parts of a decimal number: digits before and after the point, and a power of ten.
struct Decimal {
  bool negative = false;
  std::string_view whole;
  std::string_view fraction;
  int exponent = 0;
};

/// Sets value to 10 · value + digit. Returns false on overflow.
bool push_digit(std::int64_t& value, int digit) noexcept {
  return !__builtin_mul_overflow(value, 10, &value) &&
         !__builtin_add_overflow(value, digit, &value);
}

/// The magnitude of a decimal number, rounded to the nearest integer, halves away from zero.
/// Nothing on overflow.
std::optional<std::int64_t> rounded(const Decimal& decimal) noexcept {
  std::int64_t value = 0;
  // The power of ten of the next digit.
  int power = static_cast<int>(decimal.whole.size()) + decimal.exponent - 1;
  for (const std::string_view digits : {decimal.whole, decimal.fraction}) {
    for (const char c : digits) {
      const int digit = c - '0';
      if (power < 0) {
        const int carry = power == -1 && digit >= 5 ? 1 : 0;
        if (__builtin_add_overflow(value, carry, &value)) return std::nullopt;
        return value;
      }
      if (!push_digit(value, digit)) return std::nullopt;
      --power;
    }
  }
  for (; power >= 0 && value != 0; --power) {
    if (!push_digit(value, 0)) return std::nullopt;
  }
  return value;
}

/// Fast path for the usual time, digits only: one pass. Nothing for any other text, which may still
/// be a time.
std::optional<Time> parse_whole_time(std::string_view text, TimeUnit unit) noexcept {
  constexpr std::size_t kSafeDigits = 18;
  if (text.empty() || text.size() > kSafeDigits) return std::nullopt;
  std::int64_t value = 0;
  for (const char c : text) {
    if (!is_digit(c)) return std::nullopt;
    value = 10 * value + (c - '0');
  }
  for (int power = static_cast<int>(unit); power > 0; --power) {
    if (!push_digit(value, 0)) return std::nullopt;
  }
  return Time(value);
}

std::string_view take_digits(std::string_view& text) noexcept {
  std::size_t length = 0;
  while (length < text.size() && is_digit(text[length])) ++length;
  const std::string_view digits = text.substr(0, length);
  text.remove_prefix(length);
  return digits;
}

/// Skips a leading plus, which std::from_chars does not accept. Returns false if a minus follows.
bool take_plus(std::string_view& text) noexcept {
  if (!text.starts_with('+')) return true;
  text.remove_prefix(1);
  return !text.starts_with('-');
}

bool take_exponent(std::string_view text, int& exponent) noexcept {
  text.remove_prefix(1);
  if (!take_plus(text)) return false;
  constexpr int kLargest = 1000;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
  return error == std::errc{} && end == text.data() + text.size() && exponent > -kLargest &&
         exponent < kLargest;
}

std::optional<Decimal> take_apart(std::string_view text) noexcept {
  Decimal decimal;
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
    decimal.negative = text.front() == '-';
    text.remove_prefix(1);
  }
  decimal.whole = take_digits(text);
  if (!text.empty() && text.front() == '.') {
    text.remove_prefix(1);
    decimal.fraction = take_digits(text);
  }
  if (decimal.whole.empty() && decimal.fraction.empty()) return std::nullopt;
  if (text.empty()) return decimal;
  const bool has_exponent = text.front() == 'e' || text.front() == 'E';
  if (!has_exponent || !take_exponent(text, decimal.exponent)) return std::nullopt;
  return decimal;
}

}  // namespace

std::optional<TimeUnit> parse_time_unit(std::string_view text) noexcept {
  if (text == "ns") return TimeUnit::nanoseconds;
  if (text == "us") return TimeUnit::microseconds;
  if (text == "ms") return TimeUnit::milliseconds;
  if (text == "s") return TimeUnit::seconds;
  return std::nullopt;
}

std::optional<Time> parse_time(std::string_view text, TimeUnit unit) noexcept {
  text = trimmed(text);
  if (const auto whole = parse_whole_time(text, unit)) return whole;
  auto decimal = take_apart(text);
  if (!decimal) return std::nullopt;
  decimal->exponent += static_cast<int>(unit);
  const auto value = rounded(*decimal);
  if (!value) return std::nullopt;
  return Time(decimal->negative ? -*value : *value);
}

std::optional<double> parse_number(std::string_view text) noexcept {
  text = trimmed(text);
  if (!take_plus(text)) return std::nullopt;
  double value = 0;
  // std::from_chars of gcc 12 is several times slower for the same, correctly rounded, result.
  const auto [end, error] = fast_float::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  if (error != std::errc{} && error != std::errc::result_out_of_range) return std::nullopt;
  return value;
}

bool take_number(std::string_view& text, double& value) noexcept {
  const auto [end, error] = fast_float::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

bool take_time(std::string_view& text, TimeUnit unit, Time& value) noexcept {
  std::string_view rest = text;
  const auto whole = parse_whole_time(take_digits(rest), unit);
  if (!whole) return false;
  value = *whole;
  text = rest;
  return true;
}

std::optional<std::uint64_t> parse_count(std::string_view text) noexcept {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace splinecast::apps
