#include <fmt/format.h>

#include <chrono>
#include <list>

#include "apps/process/signals.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/header.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/motions/live_row.hpp"
#include "tests/campaign/motions/rules.hpp"

namespace splinecast::campaign {
namespace {

/// Concurrent rows, with three processes each.
constexpr std::size_t kAtOnce = 6;
constexpr std::array kLimits{10.0, 0.0};  ///< rad/s²; 0: none
/// Lateness of a process in s above which a row counts as held up by the machine: a lead of 50 ms
/// cannot cover it.
constexpr double kLate = 0.02;

struct LiveFindings {
  std::uint64_t limits_passed = 0;
  std::uint64_t freezes = 0;
  std::uint64_t refusals = 0;
  std::uint64_t passed_although_covered = 0;
  std::uint64_t jumps = 0;
  std::uint64_t steps = 0;
  std::uint64_t late_rows = 0;

  void judge(const Fault& fault, double limit, const LiveSeen& seen) {
    const bool is_noisy = fault.quantum > 0;
    const Peaks own{Sines::kPeakVelocity, Sines::kPeakAcceleration};
    const double most =
        limit > 0 ? limit * (1 + 1e-9) : most_without_limits(own, seen.largest_error);
    const bool is_beyond = !is_noisy && seen.peak_acceleration > most;
    limits_passed += is_beyond && limit > 0 ? 1U : 0U;
    jumps += is_beyond && limit == 0 ? 1U : 0U;
    refusals += seen.refused;
    // After a late commit the curve has changed at times already read, so steps are allowed.
    steps += seen.late_commits == 0 ? seen.steps : 0;
    const bool is_late =
        seen.producer_late > kLate || seen.solver_late > kLate || seen.late_commits > 0;
    late_rows += is_late ? 1U : 0U;
    if (is_late) return;
    freezes += seen.holding > kMostHolding ? 1U : 0U;
    if (fault.is_covered) passed_although_covered += seen.passed_over - seen.passed_at_start;
  }
  [[nodiscard]] nlohmann::json json() const {
    return {{"runs with an acceleration beyond its limit", limits_passed},
            {"runs that hold for more than 1 % of the time", freezes},
            {"waypoints refused for a reason other than lateness", refusals},
            {"waypoints passed over although the lead covered the fault", passed_although_covered},
            {"runs without limits with an excessive acceleration", jumps},
            {"position steps", steps}};
  }
};

std::string text_of(const LiveSeen& seen) {
  return fmt::format(
      "peak velocity: {:.2f} rad/s; peak acceleration: {:.2f} rad/s2; path error p99: {:.4f} rad; "
      "largest path error: {:.4f} rad; passed over: {:.1f} %; holding: {:.2f} %; samples: {}; "
      "waypoints refused as late: {}; kills: {}; deadline_misses: {}; late_commits: {}; samples "
      "revised: {}; largest delay of the producer: {:.1f} ms; largest delay of the solver: {:.1f} "
      "ms",
      seen.peak_velocity, seen.peak_acceleration, seen.error_p99, seen.largest_error,
      seen.knots > 0 ? 100 * static_cast<double>(seen.passed_over) / static_cast<double>(seen.knots)
                     : 0,
      100 * seen.holding, seen.samples, seen.came_late, seen.kills, seen.deadline_misses,
      seen.late_commits, seen.revised, 1e3 * seen.producer_late, 1e3 * seen.solver_late);
}

}  // namespace

Result run_live_motions(const CampaignOptions& options) {
  constexpr Time kStart = std::chrono::milliseconds(1000);
  const MonotonicClock clock;
  const Time begin = clock.now();
  const Sines motion(options.seed);
  LiveFindings findings;
  nlohmann::json measured;
  std::uint64_t rows = 0;
  const std::size_t all = faults().size() * kLimits.size();
  while (rows < all && !apps::stop_requested()) {
    const Time start = clock.now() + kStart;
    std::list<LiveRow> live;
    for (; rows < all && live.size() < kAtOnce; ++rows) {
      live.emplace_back(motion, faults()[rows / kLimits.size()], kLimits[rows % kLimits.size()],
                        start, campaign_stream("motion" + std::to_string(rows)));
    }
    const Time end = start + Time(static_cast<std::int64_t>(LiveRow::kSeconds * 1e9));
    while (clock.now() < end && apps::sleep_until(clock.now() + kLook)) {
      for (LiveRow& row : live) row.tick(clock.now());
    }
    for (LiveRow& row : live) {
      const LiveSeen seen = row.finish();
      findings.judge(row.fault(), row.limit(), seen);
      measured[fmt::format("{}; {}", row.fault().name,
                           row.limit() > 0 ? fmt::format("limit {} rad/s2", row.limit())
                                           : "no limit")] = text_of(seen);
    }
  }
  measured["runs in which the machine delayed a process by more than 20 ms"] = findings.late_rows;
  return make_result(
      options, {2, 4, 5, 8},
      "real-time faults: the simulated faults in real time, with producers, solvers and "
      "readers at 1 kHz as processes, and deaths by SIGKILL",
      rows, "runs of 10 s", findings.json(), std::move(measured), to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
