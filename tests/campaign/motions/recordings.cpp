#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/motions/recorded.hpp"
#include "tests/campaign/motions/rules.hpp"
#include "tests/campaign/motions/trial.hpp"

namespace splinecast::campaign {
namespace {

using Gaps = std::vector<std::pair<double, double>>;

constexpr std::array kFactors{1.5, 2.0, 4.0, 0.0};  ///< limit / peak of the spline; 0: no limit

struct Recording {
  std::string name;
  Recorded motion;
};

std::filesystem::path data_folder() {
  const char* folder = std::getenv("SPLINECAST_SHARED");
  return std::filesystem::path(folder != nullptr ? folder : SPLINECAST_SHARED) / "data";
}

std::vector<Recording> all_recordings() {
  const auto folder = data_folder();
  std::vector<Recording> recordings;
  const auto add_waypoints = [&](const std::string& file, const std::vector<std::string>& columns) {
    if (!std::filesystem::exists(folder / file)) return;
    recordings.push_back({file, Recorded::from_waypoints(folder / file, columns)});
  };
  add_waypoints("tum_rgbd_pose/freiburg1_xyz-groundtruth.txt", {"tx", "ty", "tz"});
  add_waypoints("px4_drone_log/vehicle_local_position.csv", {"x", "y", "z"});
  for (const char* flight :
       {"figure8", "figure8_ideal_traj", "multi_trajectory_ideal_traj0", "traj0"}) {
    const std::string file = fmt::format("crazyswarm2_poly/{}.csv", flight);
    if (!std::filesystem::exists(folder / file)) continue;
    recordings.push_back({file, Recorded::from_polynomials(folder / file)});
  }
  return recordings;
}

Gaps short_gaps(double seconds) {
  Gaps gaps;
  for (double from = 2; from + 1 < seconds; from += 2) gaps.emplace_back(from, from + 0.3);
  return gaps;
}

Gaps long_gap(double seconds) {
  const double from = 0.4 * seconds;
  return {{from, from + 1.7}};
}

/// Limits of velocity and acceleration of each joint; a joint that does not move has none. In two
/// flights the pieces do not join: the jumps give peaks, and so limits, that the rest of the motion
/// never reaches.
core::WindowOptions window_within(const Recorded& motion, double factor) {
  core::WindowOptions window;
  for (std::size_t joint = 0; factor > 0 && joint < motion.joints(); ++joint) {
    window.limits.velocity.push_back(factor * motion.peak(joint, 1));
    window.limits.acceleration.push_back(factor * motion.peak(joint, 2));
  }
  return window;
}

double largest_peak(const Recorded& motion, int derivative) {
  double most = 0;
  for (std::size_t joint = 0; joint < motion.joints(); ++joint) {
    most = std::max(most, motion.peak(joint, derivative));
  }
  return most;
}

/// Number of joints that exceed their limit.
std::uint64_t beyond(const std::vector<double>& peaks, const std::vector<double>& limits) {
  constexpr double kRounding = 1e-9;
  std::uint64_t count = 0;
  for (std::size_t joint = 0; joint < limits.size(); ++joint) {
    const bool is_beyond = limits[joint] > 0 && peaks[joint] > limits[joint] * (1 + kRounding);
    count += is_beyond ? 1U : 0U;
  }
  return count;
}

struct RecordingFindings {
  std::uint64_t velocities = 0;
  std::uint64_t accelerations = 0;
  std::uint64_t freezes = 0;
  std::uint64_t refusals = 0;
  std::uint64_t jumps = 0;

  void judge(const Recorded& motion, const MotionLimits& limits, const Seen& seen) {
    velocities += beyond(seen.peak_velocities, limits.velocity);
    accelerations += beyond(seen.peak_accelerations, limits.acceleration);
    freezes += seen.holding > kMostHolding ? 1U : 0U;
    refusals += seen.refused;
    const Peaks own{largest_peak(motion, 1), largest_peak(motion, 2)};
    const bool jumps_now = limits.acceleration.empty() &&
                           seen.peak_acceleration() > most_without_limits(own, seen.error(1));
    jumps += jumps_now ? 1U : 0U;
  }
  [[nodiscard]] nlohmann::json json() const {
    return {{"dimensions with a velocity beyond its limit", velocities},
            {"dimensions with an acceleration beyond its limit", accelerations},
            {"runs that hold for more than 1 % of the time", freezes},
            {"waypoints refused for a reason other than lateness", refusals},
            {"runs without limits with an excessive acceleration", jumps}};
  }
};

std::string text_of(const Recorded& motion, const Seen& seen) {
  return fmt::format(
      "peak velocity: {:.3g} /s; peak acceleration: {:.3g} /s2; peak velocity of the recording: "
      "{:.3g} /s; peak acceleration of the recording: {:.3g} /s2; path error p50: {:.2g}; path "
      "error p99: {:.2g}; largest path error: {:.2g}; passed over: {:.1f} %; holding: {:.2f} %; "
      "refused as past: {}",
      seen.peak_velocity(), seen.peak_acceleration(), largest_peak(motion, 1),
      largest_peak(motion, 2), seen.error(0.5), seen.error(0.99), seen.error(1),
      100 * static_cast<double>(seen.passed_over) / static_cast<double>(seen.knots),
      100 * seen.holding, seen.past);
}

}  // namespace

bool has_recordings() { return std::filesystem::exists(data_folder()); }

Result run_recordings(const CampaignOptions& options) {
  constexpr double kLead = 0.05;  // s
  const MonotonicClock clock;
  const Time begin = clock.now();
  RecordingFindings findings;
  nlohmann::json measured;
  std::uint64_t rows = 0;
  for (const Recording& recording : all_recordings()) {
    const Recorded& motion = recording.motion;
    const std::pair<std::string, Gaps> kinds[]{
        {"300 ms missing every 2 s", short_gaps(motion.seconds())},
        {"1.7 s missing", long_gap(motion.seconds())}};
    for (const auto& [gaps_name, gaps] : kinds) {
      const Schedule schedule = motion.schedule(kLead, gaps);
      for (const double factor : kFactors) {
        const auto window = window_within(motion, factor);
        const Seen seen = Trial(motion, schedule, {.window = window}).run();
        findings.judge(motion, window.limits, seen);
        const std::string limit =
            factor > 0 ? fmt::format("limits {:g} times the peaks", factor) : "no limit";
        measured[fmt::format("{}, {}; {}", recording.name, gaps_name, limit)] =
            text_of(motion, seen);
        ++rows;
      }
    }
  }
  return make_result(
      options, {2, 4, 5},
      "recordings: recorded motions and flights with missing waypoints, with and without "
      "limits, in simulated time through the real ring, solver, board and sampler",
      rows, "runs", findings.json(), std::move(measured), to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
