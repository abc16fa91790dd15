#include "tests/campaign/record/plan.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>

#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/streams/random.hpp"

namespace splinecast::campaign::record {
namespace {

using std::chrono::milliseconds;

std::vector<std::string> options_of(Attack attack, Random& random) {
  constexpr std::array kCompressions{"zstd", "lz4", "none"};
  const bool is_rotated = attack == Attack::rotated;
  std::vector<std::string> options{"--compression",
                                   is_rotated ? "none" : kCompressions.at(random.below(3))};
  const auto add = [&](const char* name, const std::string& value) {
    options.insert(options.end(), {name, value});
  };
  if (random.chance(0.3)) add("--states", "200");
  if (is_rotated) add("--max-size", "1MiB");
  if (attack == Attack::dumps) {
    add("--last", fmt::format("{:.3f}", random.log_uniform(0.05, 5)));
    if (random.chance(0.5)) add("--on", "refusal,takeover,underrun");
    if (random.chance(0.5)) add("--after", fmt::format("{:.3f}", random.uniform(0, 0.5)));
  }
  return options;
}

SourceKind kind_of(Random& random, Attack attack, bool has_law) {
  if (attack == Attack::rotated && random.chance(0.6)) return SourceKind::fast;
  const double part = random.unit();
  if (part < 0.35) return SourceKind::live;
  if (part < 0.5) return has_law ? SourceKind::follower : SourceKind::live;
  return part < 0.85 ? SourceKind::fast : SourceKind::unsolved;
}

}  // namespace

std::string_view to_string(Attack attack) noexcept {
  constexpr std::array<std::string_view, kAttacks> kNames{
      "none",        "paused", "slow",    "full",    "full at the end", "killed",
      "interrupted", "dumps",  "rotated", "renamed", "flooded"};
  return kNames.at(static_cast<std::size_t>(attack));
}

RunPlan make_plan(std::uint64_t seed) {
  Random random(seed);
  RunPlan plan{.seed = seed,
               .attack = static_cast<Attack>(seed % kAttacks),
               .prefix = campaign_stream(fmt::format("record{}", seed))};
  if (random.chance(0.4)) plan.law = plan.prefix + std::string(kLawName);
  plan.is_late = random.chance(0.3);
  plan.options = options_of(plan.attack, random);
  const Time length = milliseconds(700) + random.between(Time::zero(), milliseconds(1200));
  const std::size_t count = 1 + random.below(5);
  for (std::size_t i = 0; i < count; ++i) {
    plan.sources.push_back({.stream = fmt::format("{}.{}", plan.prefix, i),
                            .kind = kind_of(random, plan.attack, !plan.law.empty()),
                            .law = plan.law,
                            .seed = random.next(),
                            .length = length});
  }
  if (plan.attack == Attack::flooded) {
    plan.sources.front().kind = SourceKind::wide;
    plan.sources.front().length = length + std::chrono::seconds(2);
  }
  return plan;
}

}  // namespace splinecast::campaign::record
