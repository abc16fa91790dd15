#include "ipc/layout/options.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <type_traits>

#include "ipc/options/curve.hpp"
#include "splinecast/errors.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::ipc {
namespace {

/// A part of a file, in lower case, without marks of comments and with single spaces.
std::string text_of(const std::string& file, std::string_view begin, std::string_view end) {
  const std::string whole = testing::read_file(std::string(SPLINECAST_SOURCE) + '/' + file);
  const std::size_t from = whole.find(begin);
  const std::size_t to = whole.find(end, from);
  EXPECT_NE(to, std::string::npos) << file;
  std::string text;
  for (const char c : whole.substr(from, to - from)) {
    const bool is_space = c == ' ' || c == '\n' || c == '/' || c == '<';
    if (!is_space) text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (is_space && !text.ends_with(' ')) text += ' ';
  }
  return text;
}

std::string lower(std::string_view text) {
  std::string out;
  for (const char c : text) out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// Where a reference declares an option.
std::size_t place_of(const std::string& text, std::string_view key, bool is_python) {
  const bool is_lambda = is_python && key == "lambda";
  const std::string name = ' ' + std::string(is_lambda ? "lam" : key);
  std::size_t place = std::string::npos;
  for (const char* after : {"{", ";", " =", " :"}) place = std::min(place, text.find(name + after));
  return place;
}

/// Requires that a reference declares each option with the range and the default of its row:
/// between its name and the next one.
void expect_rows(const std::string& text, bool is_python, const auto& for_each_row) {
  for_each_row([&](const auto& row) {
    const std::size_t begin = place_of(text, row.key, is_python);
    ASSERT_NE(begin, std::string::npos) << row.key;
    std::size_t end = text.size();
    for_each_row([&](const auto& other) {
      const std::size_t place = place_of(text, other.key, is_python);
      if (place > begin) end = std::min(end, place);
    });
    const std::string own = text.substr(begin, end - begin);
    using Value = typename std::remove_cvref_t<decltype(row)>::Value;
    const bool is_number = !std::is_enum_v<Value> && !std::is_same_v<Value, bool>;
    if (is_number) {
      EXPECT_NE(own.find(lower(row.range.text)), std::string::npos) << row.key << own;
    }
    EXPECT_NE(own.find(lower(row.initial)), std::string::npos) << row.key << own;
  });
}

TEST(OptionRows, AreTheSameInEachReference) {
  const auto curve = [](const auto& visit) { for_each_option(visit); };
  const auto stream = [](const auto& visit) { for_each_stream_option(visit); };
  const char* const cpp = "ipc/include/splinecast/options.hpp";
  const char* const c = "ipc/include/splinecast.h";
  const char* const python = "ipc/python/splinecast/__init__.pyi";
  expect_rows(text_of(cpp, "struct SolverOptions {", "\n};"), false, curve);
  expect_rows(text_of(cpp, "struct IngestLimits {", "struct SolverOptions {"), false, stream);
  expect_rows(text_of(c, "typedef struct splinecast_solver_options {", "} splinecast_solver_opt"),
              false, curve);
  expect_rows(
      text_of(c, "typedef struct splinecast_producer_options {", "} splinecast_producer_op"), false,
      stream);
  expect_rows(text_of(python, "class Solver:", "    Raises\n"), true, curve);
  expect_rows(text_of(python, "class Producer:", "    Raises\n"), true, stream);
}

TEST(OptionRows, HaveDefaultsWithinTheirRanges) {
  for_each_option([](const auto& row) { EXPECT_TRUE(is_in_range(row, row.preset)) << row.key; });
  ProducerOptions initial;
  for_each_stream_option(
      [&](const auto& row) { EXPECT_TRUE(is_in_range(row, row.kOption(initial))) << row.key; });
}

TEST(OptionRows, OfABoardDoNotChangeTheLargestRateOfItsLaw) {
  RegionHeader header{};
  header.dimensions = 1;
  header.is_law = 1;
  header.largest_rate = 5;
  write_options({}, header);
  EXPECT_EQ(header.largest_rate, 5);
}

TEST(OptionRows, OutOfRangeAreRefusedByTheirNameAndRange) {
  const auto refusal = [](const SolverOptions& options) -> std::string {
    try {
      require_options(options);
    } catch (const BadRequest& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal({.stop_time = Time(0)}), "stop time must be above 0, at most 2⁶⁰ ns, not 0 ns");
  EXPECT_EQ(refusal({.largest_rate = 100.5}),
            "largest rate must be above 0, at most 100, not 100.5");
  EXPECT_EQ(refusal({.settle = 65}), "settle lag must be 0 to 64, not 65");
  EXPECT_EQ(refusal({.stop_time = kLongestStop}), "");
}

}  // namespace
}  // namespace splinecast::ipc
