#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/process/messages.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/fixtures/curves/plan_walk.hpp"

namespace splinecast::campaign {
namespace {

using testing::PlanFacts;
using testing::PlanWalk;

/// With the default seed this many plans make every transition.
constexpr std::uint64_t kHaveAllTransitions = 2'000;

nlohmann::json found_in(const PlanFacts& facts, bool has_all) {
  return {{"curves that do not end at rest", facts.restless},
          {"entries and stops beyond a limit", facts.exceeding},
          {"changes before the frozen time", facts.changed},
          {"plans with waypoints without an account", facts.unaccounted},
          {"copies that differ", facts.other_copies},
          {"transitions that no operation makes", facts.unexpected().size()},
          {"transitions that never happened", has_all ? facts.missing().size() : 0}};
}

nlohmann::json measured_of(const PlanFacts& facts, std::uint64_t first_seed) {
  nlohmann::json measured{{"first seed", first_seed},
                          {"plans", facts.plans},
                          {"entries compared with limits", facts.entries_checked},
                          {"stops compared with limits", facts.stops_checked}};
  for (std::size_t a = 0; a < PlanFacts::kStates; ++a) {
    for (std::size_t b = 0; b < PlanFacts::kStates; ++b) {
      const std::uint64_t count = facts.transitions.at(a).at(b);
      const auto name =
          fmt::format("operations from {} to {}", PlanFacts::kNames.at(a), PlanFacts::kNames.at(b));
      if (count > 0) measured[name] = count;
    }
  }
  return measured;
}

}  // namespace

Result run_plans(const CampaignOptions& options) {
  const double begin = cpu_seconds();
  PlanFacts facts;
  for (std::uint64_t i = 0;
       options.runs > 0 ? i < options.runs : cpu_seconds() - begin < options.seconds; ++i) {
    PlanWalk(options.seed + i, facts).run(i % 3 == 0 ? 150 : 20);
  }
  for (const std::string& violation : facts.first) apps::say(violation);
  const bool has_all = facts.plans >= kHaveAllTransitions;
  return make_result(
      options, {1, 4, 5, 11},
      "plans: random operations on the plan of a curve, without a board: waypoints, frozen times, "
      "cuts, starts, searches with any budget, imposed entries, copies and ends, with all methods, "
      "kinds, limits and settle lags",
      facts.operations, "operations", found_in(facts, has_all), measured_of(facts, options.seed),
      cpu_seconds() - begin);
}

}  // namespace splinecast::campaign
