#include "apps/files/numbers.hpp"

#include <fast_float/fast_float.h>

#include <array>
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
  constexpr std::size_t kSafeDigits = 19;  // of an unsigned number of 64 bits
  if (text.empty() || text.size() > kSafeDigits) return std::nullopt;
  std::uint64_t digits = 0;
  for (const char c : text) {
    if (!is_digit(c)) return std::nullopt;
    digits = 10 * digits + static_cast<std::uint64_t>(c - '0');
  }
  if (digits > std::uint64_t{INT64_MAX}) return std::nullopt;
  auto value = static_cast<std::int64_t>(digits);
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

/// Fast path for the usual number: at most 15 digits and no exponent. The digits and the power of
/// ten are exact as doubles, so their quotient is the correctly rounded value.
bool take_short_number(std::string_view& text, double& value) noexcept {
  constexpr std::size_t kMostDigits = 15;
  constexpr std::array kPowers{1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                               1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const char* at = text.data();
  const char* const end = at + text.size();
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  std::uint64_t digits = 0;
  const auto take = [&] {
    const char* const begin = at;
    for (; at != end && is_digit(*at); ++at) {
      digits = 10 * digits + static_cast<std::uint64_t>(*at - '0');
    }
    return static_cast<std::size_t>(at - begin);
  };
  const std::size_t whole = take();
  std::size_t fraction = 0;
  if (at != end && *at == '.') {
    ++at;
    fraction = take();
  }
  const std::size_t count = whole + fraction;
  const bool continues = at != end && (*at == 'e' || *at == 'E');
  if (whole == 0 || count > kMostDigits || continues) return false;
  value = static_cast<double>(digits) / kPowers[fraction];
  if (negative) value = -value;
  text.remove_prefix(static_cast<std::size_t>(at - text.data()));
  return true;
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
  if (take_short_number(text, value)) return true;
  const auto [end, error] = fast_float::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

bool take_time(std::string_view& text, TimeUnit unit, Time& value) noexcept {
  constexpr std::size_t kSafeDigits = 18;
  std::string_view rest = text;
  const std::string_view whole = take_digits(rest);
  std::string_view fraction;
  if (rest.starts_with('.')) {
    rest.remove_prefix(1);
    fraction = take_digits(rest);
  }
  int power = static_cast<int>(unit) - static_cast<int>(fraction.size());
  if (whole.empty() || whole.size() + fraction.size() > kSafeDigits || power < 0) return false;
  std::int64_t digits = 0;
  for (const char c : whole) digits = 10 * digits + (c - '0');
  for (const char c : fraction) digits = 10 * digits + (c - '0');
  for (; power > 0; --power) {
    if (!push_digit(digits, 0)) return false;
  }
  value = Time(digits);
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
