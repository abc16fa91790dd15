#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "ipc/law/commands.hpp"
#include "ipc/law/effect.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// What is in force on a time law.
struct LawReport {
  std::string law;
  bool is_solved = false;  ///< a solver has begun the law; else the next three are not valid
  double rate = 1;
  double slope = 0;  ///< [1/s]
  Time lag{};        ///< host time less stream time since the law began
  double max_rate = 1;
  std::vector<ipc::CommanderState> commanders;
  std::vector<std::string> followers;  ///< streams that follow the law
};

[[nodiscard]] std::string in_words(const LawReport& state);
[[nodiscard]] nlohmann::ordered_json to_json(const LawReport& state);

/// The effect of a ramp on one stream.
[[nodiscard]] std::string in_words(const ipc::RampEffect& effect);
[[nodiscard]] nlohmann::ordered_json to_json(const ipc::RampEffect& effect);

/// The place where an effect is nearest to a limit, or farthest beyond one.
[[nodiscard]] std::string excess_in_words(const ipc::RampEffect& effect);

}  // namespace splinecast::apps
