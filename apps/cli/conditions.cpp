#include "apps/cli/conditions.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "apps/cli/verb.hpp"
#include "apps/process/messages.hpp"

namespace splinecast::apps {

std::string present_word(const std::string& option, const std::string& text) {
  if (text != "rest") return text;
  say(fmt::format("{}: 'rest' is now 'clamped'", option));
  return "clamped";
}

namespace {

/// The condition of this name. `others`: what else the option accepts.
Condition condition_named(const std::string& option, const std::string& text,
                          std::string_view others) {
  if (auto condition = parse_condition(present_word(option, text))) return *std::move(condition);
  throw UsageError(option,
                   fmt::format("'{}' is not one of {}natural, clamped, halt, velocity=N,..., "
                               "acceleration=N,..., not-a-knot, periodic",
                               text, others));
}

}  // namespace

void take_former_rest(std::optional<End>& end) {
  if (!end || !std::holds_alternative<AtRest>(*end)) return;
  end = condition_named("--end", "rest", "");
}

void add_condition(Command& verb, const std::string& name, std::optional<Condition>& value,
                   const std::string& help) {
  verb.option(
          name,
          [&value, name](const std::string& text) { value = condition_named(name, text, ""); },
          help)
      .type("CONDITION");
}

void add_end(Command& verb, std::optional<End>& value, const std::string& help) {
  verb.option(
          "--end",
          [&value](const std::string& text) {
            if (text == "rest") {
              value = AtRest{};
            } else {
              value = condition_named("--end", text, "rest, ");
            }
          },
          help)
      .type("CONDITION");
}

}  // namespace splinecast::apps
