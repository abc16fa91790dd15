#include "splinecast/boundary_condition.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>
#include <utility>

#include "core/basics/number_text.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast {
namespace {

constexpr std::array<std::pair<ConditionKind, std::string_view>, 8> kConditionNames{{
    {ConditionKind::natural, "natural"},
    {ConditionKind::clamped, "clamped"},
    {ConditionKind::halt, "halt"},
    {ConditionKind::velocity, "velocity"},
    {ConditionKind::acceleration, "acceleration"},
    {ConditionKind::not_a_knot, "not-a-knot"},
    {ConditionKind::periodic, "periodic"},
    {ConditionKind::own, "own"},
}};

constexpr std::array<std::pair<Tail, std::string_view>, 4> kTailNames{{
    {Tail::bessel, "bessel"},
    {Tail::parabolic, "parabolic"},
    {Tail::natural, "natural"},
    {Tail::clamped, "clamped"},
}};

bool takes_values(ConditionKind kind) noexcept {
  return kind == ConditionKind::velocity || kind == ConditionKind::acceleration;
}

}  // namespace

std::optional<std::vector<double>> parse_values(std::string_view text) {
  std::vector<double> values;
  for (;;) {
    const std::size_t comma = text.find(',');
    const std::string_view field = text.substr(0, comma);
    double value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc{} || end != field.data() + field.size() || !is_usable(value)) {
      return std::nullopt;
    }
    values.push_back(value);
    if (comma == std::string_view::npos) return values;
    text.remove_prefix(comma + 1);
  }
}

std::string to_string(const Condition& condition) {
  std::string text;
  for (const auto& [kind, name] : kConditionNames) {
    if (kind == condition.kind) text = name;
  }
  char separator = '=';
  for (const double value : condition.value) {
    text.push_back(std::exchange(separator, ','));
    text += core::number_text(value);
  }
  return text;
}

std::string_view to_string(Tail tail) noexcept {
  for (const auto& [kind, name] : kTailNames) {
    if (kind == tail) return name;
  }
  return "unknown";
}

std::optional<Condition> parse_condition(std::string_view text) {
  const std::size_t equals = text.find('=');
  const std::string_view wanted = text.substr(0, equals);
  for (const auto& [kind, name] : kConditionNames) {
    if (name != wanted || kind == ConditionKind::own) continue;  // the default when none is given
    if (takes_values(kind) != (equals != std::string_view::npos)) return std::nullopt;
    if (!takes_values(kind)) return Condition{.kind = kind};
    auto values = parse_values(text.substr(equals + 1));
    if (!values) return std::nullopt;
    return Condition{.kind = kind, .value = std::move(*values)};
  }
  return std::nullopt;
}

std::optional<Tail> parse_tail(std::string_view text) noexcept {
  for (const auto& [kind, name] : kTailNames) {
    if (name == text) return kind;
  }
  return std::nullopt;
}

void require_values(const Condition& condition, std::size_t dimensions) {
  const std::size_t wanted = takes_values(condition.kind) ? dimensions : 0;
  if (condition.value.size() != wanted) {
    throw std::invalid_argument("condition '" + to_string(condition) + "' has " +
                                std::to_string(condition.value.size()) + " values; " +
                                std::to_string(wanted) + " are needed");
  }
  if (!std::ranges::all_of(condition.value, is_usable)) {
    throw std::invalid_argument("condition '" + to_string(condition) +
                                "' has a value that is not finite, or beyond 1e100");
  }
}

}  // namespace splinecast
