#pragma once

#include <optional>
#include <string>
#include <variant>

#include "apps/cli/command.hpp"
#include "splinecast/boundary_condition.hpp"

/// Options for what holds at the ends of a curve.
namespace splinecast::apps {

/// An end at rest within limits, as that of a live stream.
struct AtRest {};
/// How a curve ends at its last waypoint.
using End = std::variant<Condition, AtRest>;

/// The condition of an end; null if it has none.
[[nodiscard]] inline const Condition* condition_of(const std::optional<End>& end) noexcept {
  return end ? std::get_if<Condition>(&*end) : nullptr;
}

/// Replaces an end at rest by `clamped`, which earlier versions called `rest`, with a message on
/// stderr: for a curve that cannot end as a live stream.
void take_former_rest(std::optional<End>& end);

/// Replaces the word `rest` of earlier versions by `clamped`, with a message on stderr.
[[nodiscard]] std::string present_word(const std::string& option, const std::string& text);

/// Add an option for a boundary condition, or `--end` with a condition or `rest`.
void add_condition(Command& verb, const std::string& name, std::optional<Condition>& value,
                   const std::string& help);
void add_end(Command& verb, std::optional<End>& value, const std::string& help);

}  // namespace splinecast::apps
