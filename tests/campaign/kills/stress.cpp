#include <array>

#include "apps/process/signals.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/kills/attacked_stream.hpp"

namespace splinecast::campaign {

Result run_stress(const CampaignOptions& options) {
  constexpr std::array<std::size_t, 5> kReaders{1, 2, 4, 8, 16};
  const MonotonicClock clock;
  const Time begin = clock.now();
  Findings findings;
  nlohmann::json measured = nlohmann::json::object();
  for (const std::size_t readers : kReaders) {
    const std::string number = std::to_string(readers);
    AttackedStream stream(stress_plan(campaign_stream("stress" + number), readers));
    const Time end = clock.now() + Time(static_cast<std::int64_t>(options.seconds * 1e9));
    while (clock.now() < end && apps::sleep_until(clock.now() + kLook)) stream.tick();
    const Findings found = stream.finish();
    measured["samples with " + number + " readers"] = found.samples;
    measured["waypoints with " + number + " readers"] = found.waypoints;
    findings.add(found);
  }
  return make_result(
      options, {1, 3, 5},
      "stress: 1, 2, 4, 8 and 16 reader processes at full speed, while a producer and a "
      "solver process run at full speed over a ring of 16 items and a board of 32 "
      "segments",
      findings.samples, "samples", findings, measured, to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
