#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/starts/beginnings.hpp"

namespace splinecast::campaign {
namespace {

/// Beginnings of one stream name, one after the other.
constexpr std::size_t kOfOneName = 20;
/// With the default seed this many beginnings have every event.
constexpr std::uint64_t kHaveAllEvents = 5'000;

}  // namespace

Result run_starts(const CampaignOptions& options) {
  const MonotonicClock clock;
  const Time begin = clock.now();
  starts::Facts facts;
  const auto continues = [&](std::uint64_t seed) {
    return options.runs > 0 ? (seed - options.seed) * kOfOneName < options.runs
                            : cpu_seconds() < options.seconds;
  };
  for (std::uint64_t seed = options.seed; continues(seed) && !apps::stop_requested(); ++seed) {
    Random random(seed);
    starts::Beginnings(seed, random, facts).play(kOfOneName);
  }
  nlohmann::json found;
  for (std::size_t i = 0; i < starts::kBreaches; ++i) {
    found[std::string(to_string(static_cast<starts::Breach>(i)))] = facts.breaches[i];
  }
  nlohmann::json measured;
  std::uint64_t missing = 0;
  for (std::size_t i = 0; i < starts::kEvents; ++i) {
    const std::string name(to_string(static_cast<starts::Event>(i)));
    measured[name] = facts.events[i];
    if (facts.events[i] > 0) continue;
    ++missing;
    apps::say(fmt::format("never happened: {}", name));
  }
  const std::uint64_t count = facts.events[static_cast<std::size_t>(starts::Event::beginnings)];
  if (count >= kHaveAllEvents) found["required events that never happened"] = missing;
  measured["first seed"] = options.seed;
  measured["largest velocity without a counted excess, limit 3"] = facts.largest_velocity;
  measured["largest acceleration without a counted excess, limit 15"] = facts.largest_acceleration;
  return make_result(
      options, {4, 5, 8, 11},
      "starts: producers of one stream name after the other, in simulated time, which begin near "
      "and far, late and early, with times of other clocks, and are finished, killed and removed "
      "at any time; a controller follows what it finds",
      count, "beginnings", found, std::move(measured), to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
