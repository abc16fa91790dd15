#include "apps/rate/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

std::string request_of(const ipc::CommanderState& commander) {
  const ipc::RateCommand& command = commander.command;
  if (command.rate < 0) return "no request";
  const std::string rate =
      fmt::format("rate {:g}, ramp {:g} s", command.rate, to_seconds(command.ramp));
  if (command.dead_man == Time::zero()) return rate;
  return fmt::format("{}, dead man {:g} s{}", rate, to_seconds(command.dead_man),
                     commander.is_dead ? ": expired, holds" : "");
}

ordered_json commander_json(const ipc::CommanderState& commander) {
  const ipc::RateCommand& command = commander.command;
  ordered_json json{{"name", commander.name}};
  json["rate"] = command.rate < 0 ? ordered_json() : ordered_json(command.rate);
  json["ramp_s"] = to_seconds(command.ramp);
  json["dead_man_s"] = to_seconds(command.dead_man);
  json["dead_man_expired"] = commander.is_dead;
  return json;
}

/// A rate or its slope without the rounding error of the curve that gives it: 0 below 1e-9.
double shown(double value) {
  constexpr double kRounding = 1e-9;
  return std::abs(value) < kRounding ? 0 : value;
}

std::string name_of(const ipc::RampEffect& effect, std::size_t d) {
  return effect.names[d].empty() ? std::to_string(d) : effect.names[d];
}

}  // namespace

std::string in_words(const LawReport& state) {
  std::string text;
  if (state.is_solved) {
    text =
        fmt::format("'{}': rate {:g}, slope {:g} /s, {:g} at most; lag {:.3f} s\n", state.law,
                    shown(state.rate), shown(state.slope), state.max_rate, to_seconds(state.lag));
  } else {
    text = fmt::format("'{}': waiting for a solver\n", state.law);
  }
  for (const ipc::CommanderState& commander : state.commanders) {
    text += fmt::format("  {:<16} {}\n", commander.name, request_of(commander));
  }
  if (!state.followers.empty()) {
    text += fmt::format("  followed by {}\n", fmt::join(state.followers, ", "));
  }
  return text;
}

ordered_json to_json(const LawReport& state) {
  ordered_json json{{"law", state.law}, {"solved", state.is_solved}};
  if (state.is_solved) {
    json["rate"] = shown(state.rate);
    json["slope_per_s"] = shown(state.slope);
    json["largest_rate"] = state.max_rate;
    json["lag_s"] = to_seconds(state.lag);
  }
  json["commanders"] = ordered_json::array();
  for (const ipc::CommanderState& commander : state.commanders) {
    json["commanders"].push_back(commander_json(commander));
  }
  json["followers"] = state.followers;
  return json;
}

std::string in_words(const ipc::RampEffect& effect) {
  std::string text = fmt::format("'{}': largest velocity, acceleration and jerk\n", effect.stream);
  for (std::size_t d = 0; d < effect.velocity.size(); ++d) {
    text += fmt::format("  {:<16} {:>10.4g} {:>10.4g} {:>10.4g}\n", name_of(effect, d),
                        effect.velocity[d], effect.acceleration[d], effect.jerk[d]);
  }
  return text;
}

ordered_json to_json(const ipc::RampEffect& effect) {
  return {{"stream", effect.stream},
          {"velocity", effect.velocity},
          {"acceleration", effect.acceleration},
          {"jerk", effect.jerk},
          {"limit_ratio", effect.worst.ratio}};
}

std::string excess_in_words(const ipc::RampEffect& effect) {
  const Excess& worst = effect.worst;
  return fmt::format("{} of '{}' in dimension {} would be {:.4g}, limit {:.4g}",
                     to_string(worst.kind), effect.stream, name_of(effect, worst.dimension),
                     worst.value, worst.limit);
}

}  // namespace splinecast::apps
