#include <fmt/format.h>

#include <array>
#include <ctime>
#include <thread>

#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/ends/life.hpp"

namespace splinecast::campaign {
namespace {

constexpr std::size_t kThreads = 2;
/// With the default seed this many lives have every required event.
constexpr std::uint64_t kHaveAllEvents = 20'000;

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Lives every kThreads-th seed from `first` on.
void live(const CampaignOptions& options, std::uint64_t first, ends::Tally& tally) {
  const auto continues = [&](std::uint64_t seed) {
    return options.runs > 0 ? seed - options.seed < options.runs
                            : thread_seconds() < options.seconds;
  };
  for (std::uint64_t seed = first; continues(seed) && !apps::stop_requested(); seed += kThreads) {
    Random random(seed);
    const ends::LifePlan plan = ends::make_life(seed, random);
    ends::Life(plan, tally, random).run();
  }
}

}  // namespace

Result run_ends(const CampaignOptions& options) {
  const MonotonicClock clock;
  const Time begin = clock.now();
  std::array<ends::Tally, kThreads> tallies;
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < kThreads; ++i) {
      threads.emplace_back([&, i] { live(options, options.seed + i, tallies[i]); });
    }
  }
  ends::Tally all;
  for (const ends::Tally& tally : tallies) all.add(tally);
  auto breaches = all.found();
  if (options.runs == 0 || options.runs >= kHaveAllEvents) {
    const auto missing = all.not_covered();
    breaches["required events that never happened"] = missing.size();
    for (const std::string& name : missing) apps::say(fmt::format("never happened: {}", name));
  }
  auto measured = all.measured();
  measured["first seed"] = options.seed;
  return make_result(
      options, {1, 2, 4, 5, 8, 11},
      "ends: lives of live streams, one per seed, that end in every way: finish with each "
      "condition, stops, replacements, deaths and takeovers, at any time, with any limits, bounds, "
      "methods, kinds of dimensions and laws; every revision is checked",
      all.lives(), "lives", breaches, std::move(measured), to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
