#include "apps/files/polynomial_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <chrono>

#include "apps/files/lines.hpp"
#include "apps/files/numbers.hpp"
#include "apps/files/text_file.hpp"
#include "apps/process/exit_codes.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {
namespace {

/// A polynomial's column: dimension and power.
struct Column {
  std::size_t dimension = 0;
  std::size_t power = 0;

  friend bool operator==(const Column&, const Column&) = default;
};

/// The header of a file.
struct Format {
  std::vector<std::string> names;
  std::vector<Column> columns;  ///< of fields 1, 2, …
  std::size_t order = 0;
};

[[noreturn]] void fail(const TextFile& file, const Line& line, const std::string& what) {
  throw InputError(fmt::format("{}:{}: {}", file.name(), line.number, what));
}

/// The fields of a line. A comma at the end of the line starts no further field.
std::vector<std::string_view> fields_of(const Line& line) {
  std::vector<std::string_view> fields;
  split_at_commas(line.text, fields);
  if (without_blanks(fields.back()).empty()) fields.pop_back();
  return fields;
}

bool is_duration(std::string_view name) {
  return std::ranges::equal(name, std::string_view("duration"),
                            [](unsigned char a, char b) { return std::tolower(a) == b; });
}

Format read_header(const TextFile& file, const Line& line) {
  Format format;
  const auto fields = fields_of(line);
  if (fields.empty() || !is_duration(trimmed(fields[0]))) {
    fail(file, line, "the first column is not 'duration'");
  }
  for (std::size_t i = 1; i < fields.size(); ++i) {
    const std::string_view field = trimmed(fields[i]);
    const std::size_t caret = field.find('^');
    const auto power =
        caret == std::string_view::npos ? std::nullopt : parse_count(field.substr(caret + 1));
    if (!power || *power >= static_cast<std::size_t>(kMaxPolynomialOrder)) {
      fail(file, line, fmt::format("column '{}' has no valid power, such as x^0", field));
    }
    const std::string name(field.substr(0, caret));
    if (name.empty()) fail(file, line, fmt::format("column '{}' has no dimension name", field));
    const auto found = std::ranges::find(format.names, name);
    const auto dimension = static_cast<std::size_t>(found - format.names.begin());
    if (found == format.names.end()) format.names.push_back(name);
    const Column column{dimension, *power};
    if (std::ranges::find(format.columns, column) != format.columns.end()) {
      fail(file, line, fmt::format("column '{}' occurs twice", field));
    }
    format.columns.push_back(column);
    format.order = std::max<std::size_t>(format.order, *power + 1);
  }
  if (format.names.empty() || format.names.size() > kMaxDimensions) {
    fail(file, line, fmt::format("{} dimensions, not 1 to 64", format.names.size()));
  }
  return format;
}

/// Limit for each piece, and for the whole trajectory.
constexpr Time kLongestPiece = std::chrono::hours(24 * 366);

Time duration_of(const TextFile& file, const Line& line, std::string_view field) {
  const auto duration = parse_time(without_blanks(field), TimeUnit::seconds);
  if (!duration || *duration <= Time::zero() || *duration > kLongestPiece) {
    fail(file, line,
         fmt::format("'{}' is not a duration above 0 and up to 366 days", without_blanks(field)));
  }
  return *duration;
}

void append_piece(const TextFile& file, const Line& line, const Format& format,
                  PiecewisePolynomial& curve) {
  const auto fields = fields_of(line);
  if (fields.size() != format.columns.size() + 1) {
    fail(file, line,
         fmt::format("{} fields; the header has {}", fields.size(), format.columns.size() + 1));
  }
  std::vector<double> coefficients(format.order * format.names.size());
  for (std::size_t i = 0; i < format.columns.size(); ++i) {
    const auto value = parse_number(without_blanks(fields[i + 1]));
    const Column& column = format.columns[i];
    if (!value || !is_usable(*value)) {
      fail(
          file, line,
          fmt::format("column '{}^{}': '{}' is not a number from -1e100 to 1e100",
                      format.names[column.dimension], column.power, without_blanks(fields[i + 1])));
    }
    coefficients[column.power * format.names.size() + column.dimension] = *value;
  }
  const Time left = curve.segments() == 0 ? Time::zero() : curve.breaks().back();
  const Time right = left + duration_of(file, line, fields[0]);
  if (right > kLongestPiece) fail(file, line, "the trajectory is longer than 366 days");
  curve.append(left, right, static_cast<int>(format.order), coefficients);
}

}  // namespace

PolynomialFile read_polynomials(const std::string& path) {
  const TextFile file(path);
  Lines lines(file.text());
  Line line;
  if (!lines.next_data(line)) throw InputError(fmt::format("{}: there is no header", file.name()));
  const Format format = read_header(file, line);
  PolynomialFile result{.names = format.names, .curve = PiecewisePolynomial(format.names.size())};
  while (lines.next_data(line)) append_piece(file, line, format, result.curve);
  if (result.curve.segments() == 0) {
    throw InputError(fmt::format("{}: there are no rows", file.name()));
  }
  return result;
}

}  // namespace splinecast::apps
