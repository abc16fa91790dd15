#include "apps/limits/options.hpp"

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <string_view>

#include "apps/cli/options.hpp"
#include "apps/files/numbers.hpp"

namespace splinecast::apps {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The fields of a list that is separated by commas.
std::vector<std::string_view> fields_of(std::string_view text) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = text.find(',');
    fields.push_back(without_blanks(text.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    text.remove_prefix(comma + 1);
  }
}

/// Reads a number. Returns the argument `none` for an empty field and for the word "none", and
/// nullopt for any other text.
std::optional<double> number_or(double none, std::string_view field) {
  if (field.empty() || field == "none") return none;
  return parse_number(field);
}

void add_list(Command& verb, const std::string& name, const std::string& type,
              std::vector<double>& values, const std::string& help) {
  verb.option(
          name,
          [&values, name](const std::string& text) {
            values.clear();
            for (const std::string_view field : fields_of(text)) {
              const auto value = number_or(0, field);
              if (!value) {
                throw UsageError(
                    name,
                    fmt::format("'{}' is not a list of numbers such as 10 or 10,none,5", text));
              }
              values.push_back(*value);
            }
          },
          help)
      .type(type);
}

/// Reads `LO:HI`; either or both may be missing. Returns false for any other text.
bool parse_bounds(std::string_view field, MotionLimits& limits) {
  const std::size_t colon = field.find(':');
  const bool is_none = field.empty() || field == "none";
  if (!is_none && colon == std::string_view::npos) return false;
  const auto lower = number_or(-kInfinity, is_none ? "" : field.substr(0, colon));
  const auto upper = number_or(kInfinity, is_none ? "" : field.substr(colon + 1));
  if (!lower || !upper) return false;
  limits.lower.push_back(*lower);
  limits.upper.push_back(*upper);
  return true;
}

void add_bounds(Command& verb, MotionLimits& limits) {
  verb.option(
          "--bounds",
          [&limits](const std::string& text) {
            limits.lower.clear();
            limits.upper.clear();
            for (const std::string_view field : fields_of(text)) {
              if (parse_bounds(field, limits)) continue;
              throw UsageError(
                  "--bounds",
                  fmt::format("'{}' is not a list of bounds such as -1:1,none,0:", text));
            }
          },
          "Lower and upper bound of the position: one pair, or one per dimension; LO, HI or both "
          "(none) may be left out (default none)")
      .type("LO:HI,...");
}

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) {
    list += list.empty() ? "" : ", ";
    list += '\'' + name + '\'';
  }
  return list;
}

}  // namespace

void add_limit_options(Command& verb, LimitOptions& options, const std::string& scope) {
  const std::string form =
      ": one number, or one per dimension; 0, none or empty for no limit (default none)" + scope;
  add_list(verb, "--max-velocity", "V,...", options.given.velocity,
           "Largest velocity, in units/s" + form);
  add_list(verb, "--max-acceleration", "A,...", options.given.acceleration,
           "Largest acceleration, in units/s^2" + form);
  add_list(verb, "--max-jerk", "J,...", options.given.jerk, "Largest jerk, in units/s^3" + form);
  add_bounds(verb, options.given);
  verb.option(
          "--limits", options.file,
          "File of limits by dimension name: joint_limits.yaml of MoveIt, or a URDF; --max-* and "
          "--bounds replace its limits of the same kind")
      .type("FILE");
}

LimitGaps limit_gaps(const MotionLimits& limits, std::span<const NamedLimits> joints,
                     std::span<const std::string> names, std::span<const Dimension> kinds) {
  LimitGaps gaps{.unmatched = core::unmatched(joints, names), .without = {}};
  for (const std::size_t d : core::without_limits(limits, kinds)) {
    const bool has_name = d < names.size() && !names[d].empty();
    gaps.without.push_back(has_name ? names[d] : std::to_string(d));
  }
  return gaps;
}

std::vector<std::string> to_lines(const LimitGaps& gaps) {
  std::vector<std::string> lines;
  if (!gaps.unmatched.empty()) {
    lines.push_back("these limits match no dimension: " + listed(gaps.unmatched));
  }
  if (!gaps.without.empty()) {
    lines.push_back("these dimensions have no limit: " + listed(gaps.without));
  }
  return lines;
}

}  // namespace splinecast::apps
