#include "apps/files/numbers.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <tuple>
#include <vector>

namespace splinecast::apps {
namespace {

TEST(Numbers, AreTakenFromTheBeginningOfATextWithTheSameValue) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 20'000; ++i) {
    std::string text = std::to_string(random() >> (random() % 64));
    if (random() % 3 > 0) text.insert(random() % (text.size() + 1), ".");
    if (random() % 5 == 0) text += "e-" + std::to_string(random() % 30);
    if (random() % 2 == 0) text.insert(0, "-");
    std::string_view rest = text;
    double value = 0;
    if (take_number(rest, value)) {
      const std::string taken = text.substr(0, text.size() - rest.size());
      ASSERT_EQ(std::bit_cast<std::uint64_t>(value),
                std::bit_cast<std::uint64_t>(parse_number(taken).value()))
          << text;
    }
    rest = text;
    Time time{};
    for (const TimeUnit unit : {TimeUnit::nanoseconds, TimeUnit::milliseconds, TimeUnit::seconds}) {
      rest = text;
      if (!take_time(rest, unit, time)) continue;
      ASSERT_EQ(time, parse_time(text.substr(0, text.size() - rest.size()), unit)) << text;
    }
  }
  std::string_view fields = "0.5,12.25;x";
  Time time{};
  double value = 0;
  ASSERT_TRUE(take_time(fields, TimeUnit::seconds, time));
  EXPECT_EQ(time, Time(500'000'000));
  EXPECT_EQ(fields, ",12.25;x");
  fields.remove_prefix(1);
  ASSERT_TRUE(take_number(fields, value));
  EXPECT_EQ(value, 12.25);
  EXPECT_EQ(fields, ";x");
  for (std::string_view text : {"", ",1", " 1", "\"1\"", "x"}) {
    EXPECT_FALSE(take_number(text, value)) << text;
    EXPECT_FALSE(take_time(text, TimeUnit::seconds, time)) << text;
  }
}

TEST(Numbers, TimesAreReadExactlyInEveryUnit) {
  const std::vector<std::tuple<const char*, TimeUnit, std::int64_t>> cases{
      {"1403636579.763555584", TimeUnit::seconds, 1403636579763555584},
      {"1305031098.6659", TimeUnit::seconds, 1305031098665900000},
      {"9223372036.854775807", TimeUnit::seconds, 9223372036854775807},
      {"9223372036854775807", TimeUnit::nanoseconds, 9223372036854775807},
      {"20321827", TimeUnit::microseconds, 20321827000},
      {"-0.000000001", TimeUnit::seconds, -1},
      {"1e-9", TimeUnit::seconds, 1},
      {"1.5E3", TimeUnit::seconds, 1500000000000},
      {"+2.", TimeUnit::milliseconds, 2000000},
      {".5", TimeUnit::seconds, 500000000},
      {" \"7\" ", TimeUnit::nanoseconds, 7},
      {"0.0000000004", TimeUnit::seconds, 0},
      {"0.0000000005", TimeUnit::seconds, 1},
      {"-0.0000000015", TimeUnit::seconds, -2},
      {"000000000000000000000000012", TimeUnit::nanoseconds, 12},
      {"0e999", TimeUnit::seconds, 0},
      {"12345678901e-2", TimeUnit::nanoseconds, 123456789},
  };
  for (const auto& [text, unit, wanted] : cases) {
    const auto time = parse_time(text, unit);
    ASSERT_TRUE(time.has_value()) << text;
    EXPECT_EQ(time->count(), wanted) << text;
  }
}

TEST(Numbers, InvalidTimesAreRejected) {
  for (const char* text : {"", " ", ".", "-", "1.2.3", "1e", "1e+", "1e+-1", "nan", "inf", "0x10",
                           "1 2", "9223372036854775808", "1e30", "1,5", "12s"}) {
    EXPECT_FALSE(parse_time(text, TimeUnit::nanoseconds).has_value()) << text;
  }
  EXPECT_FALSE(parse_time("9223372037", TimeUnit::seconds).has_value());
}

TEST(Numbers, NumbersAreReadCompletelyOrRejected) {
  EXPECT_EQ(parse_number("-1.25e-3"), -1.25e-3);
  EXPECT_EQ(parse_number(" +3 "), 3.0);
  EXPECT_TRUE(std::isnan(parse_number("nan").value()));
  EXPECT_EQ(parse_number("-inf"), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_number("1e999"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_number("-1e-999"), 0.0);
  for (const char* text : {"", "1x", "x", "--1", "1 2", "0x1p3", ".", "1e", "+-1"}) {
    EXPECT_FALSE(parse_number(text).has_value()) << text;
  }
}

TEST(Numbers, EveryNumberIsReadAsTheNearestDouble) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 100'000; ++i) {
    const double wanted = std::bit_cast<double>(random());
    if (!std::isfinite(wanted)) continue;
    for (const char* const format : {"%.17g", "%.25e", "%.3e"}) {
      std::array<char, 64> text{};
      std::snprintf(text.data(), text.size(), format, wanted);
      ASSERT_EQ(parse_number(text.data()), std::strtod(text.data(), nullptr)) << text.data();
    }
  }
}

}  // namespace
}  // namespace splinecast::apps
