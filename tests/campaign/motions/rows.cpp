#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/motions/ended.hpp"
#include "tests/campaign/motions/rules.hpp"
#include "tests/campaign/motions/schedule.hpp"
#include "tests/campaign/motions/sines.hpp"
#include "tests/campaign/motions/trace.hpp"
#include "tests/campaign/motions/trial.hpp"

namespace splinecast::campaign {
namespace {

constexpr std::array kLimits{5.0, 10.0, 20.0, 0.0};  ///< rad/s²; 0: none
constexpr double kNoise = 1e-4;                      ///< rad

core::WindowOptions window_within(double limit) {
  core::WindowOptions window;
  if (limit > 0) window.limits.acceleration.assign(Sines::kJoints, limit);
  return window;
}

/// Violations of a row.
struct MotionFindings {
  std::uint64_t limits_passed = 0;
  std::uint64_t freezes = 0;
  std::uint64_t refusals = 0;
  std::uint64_t passed_although_covered = 0;
  std::uint64_t jumps = 0;

  [[nodiscard]] nlohmann::json json() const {
    return {{"runs with an acceleration beyond its limit", limits_passed},
            {"runs that hold for more than 1 % of the time", freezes},
            {"waypoints refused for a reason other than lateness", refusals},
            {"waypoints passed over although the lead covered the fault", passed_although_covered},
            {"runs without limits with an excessive acceleration", jumps}};
  }
};

void judge(const Fault& fault, double limit, bool has_noise, const Seen& seen,
           MotionFindings& findings) {
  // The spline through noisy waypoints itself exceeds the limits.
  const bool is_noisy = has_noise || fault.quantum > 0;
  const bool is_beyond = limit > 0 && !is_noisy && seen.peak_acceleration() > limit * (1 + 1e-9);
  findings.limits_passed += is_beyond ? 1U : 0U;
  const bool jumps =
      limit == 0 && !is_noisy &&
      seen.peak_acceleration() >
          most_without_limits({Sines::kPeakVelocity, Sines::kPeakAcceleration}, seen.error(1));
  findings.jumps += jumps ? 1U : 0U;
  findings.freezes += seen.holding > kMostHolding ? 1U : 0U;
  findings.refusals += seen.refused;
  if (fault.is_covered) {
    findings.passed_although_covered += seen.passed_over - seen.passed_at_start;
  }
}

std::string row_name(const Fault& fault, double limit, bool is_noisy) {
  return fmt::format("{}{}; {}", fault.name, is_noisy ? ", noise of 0.1 mrad" : "",
                     limit > 0 ? fmt::format("limit {} rad/s2", limit) : "no limit");
}

std::string row_text(const Fault& fault, std::size_t which_limit, bool is_noisy, const Seen& seen) {
  std::string text = fmt::format(
      "peak velocity: {:.2f} rad/s; peak acceleration: {:.2f} rad/s2; peak acceleration in "
      "entries: {:.2f} rad/s2; path error p50: {:.4f} rad; path error p99: {:.4f} rad; largest "
      "path error: {:.4f} rad; passed over: {:.1f} %; holding: {:.2f} %",
      seen.peak_velocity(), seen.peak_acceleration(), seen.entry_acceleration, seen.error(0.5),
      seen.error(0.99), seen.error(1),
      100 * static_cast<double>(seen.passed_over) / static_cast<double>(seen.knots),
      100 * seen.holding);
  if (is_noisy || which_limit >= fault.simulated.size()) return text;
  const auto [p99, largest] = fault.simulated[which_limit];
  if (p99 > 0) {
    text += fmt::format(
        "; path error p99 in an independent simulation: {} rad; largest path error in an "
        "independent simulation: {} rad",
        p99, largest);
  }
  return text;
}

void trace(const Sines& motion, const CampaignOptions& options) {
  constexpr double kLimit = 10;  // rad/s²
  Traces traces(options.trace);
  for (const Fault& fault : faults()) {
    if (fault.file.empty()) continue;
    for (const double limit : {kLimit, 0.0}) {
      traces.add(motion, fault, limit,
                 {.window = window_within(limit), .quantum = fault.quantum, .seed = options.seed});
    }
  }
  for (const Ended& ended : ends()) {
    for (const double limit : {kLimit, 0.0})
      traces.add(motion, ended, limit, {.seed = options.seed});
  }
  traces.finish();
}

}  // namespace

std::string list_motions() {
  std::string text;
  for (const Fault& fault : faults()) text += fmt::format("{}\t{}\n", fault.file, fault.name);
  for (const Ended& ended : ends()) text += fmt::format("{}\t{}\n", ended.file, ended.name);
  return text;
}

Result run_motions(const CampaignOptions& options) {
  const MonotonicClock clock;
  const Time begin = clock.now();
  MotionFindings findings;
  nlohmann::json measured;
  std::uint64_t rows = 0;
  const Sines motion(options.seed);
  if (!options.trace.empty()) trace(motion, options);
  for (const Fault& fault : faults()) {
    const Schedule schedule = fault.make(motion, options.seed);
    for (const bool is_noisy : {false, true}) {
      for (std::size_t i = 0; i < kLimits.size(); ++i) {
        const Seen seen = Trial(motion, schedule,
                                {.window = window_within(kLimits[i]),
                                 .beyond = options.beyond,
                                 .noise = is_noisy ? kNoise : 0,
                                 .quantum = fault.quantum,
                                 .seed = options.seed})
                              .run();
        judge(fault, kLimits[i], is_noisy, seen, findings);
        measured[row_name(fault, kLimits[i], is_noisy)] = row_text(fault, i, is_noisy, seen);
        ++rows;
      }
    }
  }
  return make_result(
      options, {2, 4, 5},
      "simulated faults: a motion of six joints whose producer is late, silent, dead or "
      "replans, with and without limits, in simulated time through the real ring, "
      "solver, board and sampler",
      rows, "runs of 20 s", findings.json(), std::move(measured), to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
