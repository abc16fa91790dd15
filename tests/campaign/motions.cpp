#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "campaign/campaigns.hpp"
#include "campaign/motions/schedule.hpp"
#include "splinecast/ipc/sampler.hpp"
#include "support/memory_stream.hpp"
#include "support/output.hpp"
#include "version.hpp"

namespace splinecast::campaign {
namespace {

using core::Time;

constexpr std::array kLimits{5.0, 10.0, 20.0, 0.0};  ///< rad/s²; 0: none
constexpr double kLead = 0.3;                        ///< s: the first call may be so early
constexpr double kSettling = 2;  ///< s, after which the start is not measured any more

/// What a 1 kHz reader saw of one schedule, and what became of the waypoints.
struct Seen {
  std::vector<double> errors;  ///< rad, at each sample: the largest of all joints
  double peak_velocity = 0;
  double peak_acceleration = 0;
  double holding = 0;         ///< share of the samples, but those in pauses
  std::uint64_t refused = 0;  ///< but those that came too late
  std::uint64_t knots = 0;
  std::uint64_t passed_over = 0;
  std::uint64_t passed_at_start = 0;
  std::uint64_t starvations = 0;

  [[nodiscard]] double error(double share) const {
    return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
  }
};

Time to_time(double seconds) { return Time(std::llround(seconds * 1e9)); }

/// A stream in plain memory, in simulated time, with a reader at 1 kHz.
class Trial {
 public:
  Trial(const Sines& motion, Schedule schedule, double limit, double noise, std::uint64_t seed)
      : motion_(motion),
        schedule_(std::move(schedule)),
        random_(seed),
        noise_(noise),
        stream_(Sines::kJoints, window(limit), 4096, 4096, {}, {}, ipc::LiveOptions{}),
        sampler_(stream_.board.reader, ipc::StreamClock::monotonic, {}) {}

  Seen run() {
    constexpr int kMilliseconds = 1000;
    const int end = static_cast<int>(Sines::kSeconds * kMilliseconds);
    for (int ms = -static_cast<int>(kLead * kMilliseconds); ms < end; ++ms) {
      now_ = static_cast<double>(ms) / kMilliseconds;
      stream_.clock.time = kBegin + to_time(now_);
      produce();
      solve();
      if (ms >= 0) read();
      if (now_ <= kSettling) seen_.passed_at_start = stream_.solver.head().passed_over;
    }
    const ipc::Head& head = stream_.solver.head();
    const auto past = head.reasons[static_cast<std::size_t>(ipc::Refusal::past)];
    seen_.refused = head.refused - past + refused_;
    seen_.knots = head.knots;
    seen_.passed_over = head.passed_over;
    seen_.starvations = head.underruns;
    seen_.holding = samples_ > 0 ? static_cast<double>(held_) / static_cast<double>(samples_) : 1;
    std::ranges::sort(seen_.errors);
    return std::move(seen_);
  }

 private:
  static constexpr Time kBegin{1'000'000'000'000};

  static core::WindowOptions window(double limit) {
    core::WindowOptions how;
    how.held_before_start = true;
    how.start.kind = core::ConditionKind::halt;
    if (limit > 0) how.limits.acceleration.assign(Sines::kJoints, limit);
    return how;
  }

  void produce() {
    for (; next_ < schedule_.calls.size() && schedule_.calls[next_].at <= now_; ++next_) {
      const Call& call = schedule_.calls[next_];
      std::vector<std::vector<double>> positions = call.positions;
      std::normal_distribution<> noise(0, noise_);
      std::vector<core::Waypoint> waypoints;
      for (std::size_t i = 0; i < positions.size(); ++i) {
        if (noise_ > 0) {
          for (double& x : positions[i]) x += noise(random_);
        }
        waypoints.push_back({.time = kBegin + to_time(call.times[i]), .position = positions[i]});
      }
      const ipc::WaypointRingWriter::Solved solved{
          .consumed = stream_.board.reader.tail(),
          .settled_until = stream_.board.reader.look().settled_until,
          .clock = &stream_.clock};
      if (call.replaces_from) {
        count(stream_.ring.writer.replace_from(kBegin + to_time(*call.replaces_from), waypoints,
                                               solved));
      } else {
        for (const core::Waypoint& waypoint : waypoints) {
          count(stream_.ring.writer.append(waypoint, solved));
        }
      }
    }
  }
  void count(ipc::AppendStatus status) {
    const bool is_fine = status == ipc::AppendStatus::accepted || status == ipc::AppendStatus::past;
    refused_ += is_fine ? 0U : 1U;
  }

  void solve() {
    constexpr int kStepsPerMillisecond = 8;
    if (death_ < schedule_.deaths.size() && now_ >= schedule_.deaths[death_].first) {
      if (now_ < schedule_.deaths[death_].second) return;
      stream_.replace_solver();
      ++death_;
    }
    for (int i = 0; i < kStepsPerMillisecond; ++i) {
      const auto result = stream_.solver.step(stream_.clock);
      if (result.consumed == 0 && stream_.solver.due() > stream_.clock.time) return;
    }
  }

  void read() {
    const auto status = sampler_.sample(stream_.clock.time, state_);
    if (!ipc::has_values(status)) return;
    const auto is_now = [&](const auto& pause) {
      return now_ >= pause.first && now_ < pause.second;
    };
    if (std::ranges::none_of(schedule_.pauses, is_now) &&
        std::ranges::none_of(schedule_.deaths, is_now)) {
      ++samples_;
      held_ += status == ipc::SampleStatus::holding ? 1U : 0U;
    }
    double error = 0;
    for (std::size_t joint = 0; joint < Sines::kJoints; ++joint) {
      error = std::max(error, std::abs(state_.position()[joint] - motion_.at(joint, now_)));
      seen_.peak_velocity = std::max(seen_.peak_velocity, std::abs(state_.velocity()[joint]));
      seen_.peak_acceleration =
          std::max(seen_.peak_acceleration, std::abs(state_.acceleration()[joint]));
    }
    if (now_ >= kSettling) seen_.errors.push_back(error);
  }

  const Sines& motion_;
  Schedule schedule_;
  std::mt19937_64 random_;
  double noise_;
  testing::MemoryStream stream_;
  ipc::Sampler sampler_;
  core::State state_{Sines::kJoints};
  Seen seen_;
  double now_ = 0;
  std::size_t next_ = 0;
  std::size_t death_ = 0;
  std::uint64_t refused_ = 0;
  std::uint64_t samples_ = 0;
  std::uint64_t held_ = 0;
};

/// What must not happen in a row.
struct MotionFindings {
  std::uint64_t limits_passed = 0;
  std::uint64_t freezes = 0;
  std::uint64_t refusals = 0;
  std::uint64_t passed_although_covered = 0;
  std::uint64_t jumps = 0;

  [[nodiscard]] nlohmann::json json() const {
    return {{"accelerations beyond their limit", limits_passed},
            {"rows held for more than 1 % of the time", freezes},
            {"waypoints refused that did not come too late", refusals},
            {"waypoints passed over although the lead covered the hiccup", passed_although_covered},
            {"jumps without limits", jumps}};
  }
  [[nodiscard]] bool is_sound() const {
    return limits_passed + freezes + refusals + passed_although_covered + jumps == 0;
  }
};

/// The largest acceleration that a row without limits may show: three times the motion's own, that
/// of a stop from its peak velocity, or that of a motion over the distance in a second.
double most_without_limits(const Seen& seen) {
  constexpr double kSlack = 1.1;
  constexpr double kFar = 0.5;  // rad: then the motion goes on for long meanwhile
  const double stop = core::to_seconds(core::WindowOptions{}.stop_time);
  const double way = seen.error(1) > kFar ? seen.error(1) + Sines::kPeakVelocity : 0;
  return kSlack *
         std::max({3 * Sines::kPeakAcceleration, 1.5 * Sines::kPeakVelocity / stop, 6 * way});
}

void judge(const Mishap& mishap, double limit, bool is_noisy, const Seen& seen,
           MotionFindings& findings) {
  constexpr double kMostHolding = 0.01;
  // The spline of noisy waypoints is beyond the limits itself.
  const bool is_beyond = limit > 0 && !is_noisy && seen.peak_acceleration > limit * (1 + 1e-9);
  findings.limits_passed += is_beyond ? 1U : 0U;
  const bool jumps = limit == 0 && !is_noisy && seen.peak_acceleration > most_without_limits(seen);
  findings.jumps += jumps ? 1U : 0U;
  findings.freezes += seen.holding > kMostHolding ? 1U : 0U;
  findings.refusals += seen.refused;
  if (mishap.is_covered) {
    findings.passed_although_covered += seen.passed_over - seen.passed_at_start;
  }
}

std::string row_name(const Mishap& mishap, double limit, bool is_noisy) {
  return fmt::format("{}{}, {}", mishap.name, is_noisy ? ", noise of 0.1 mrad" : "",
                     limit > 0 ? fmt::format("limit {} rad/s2", limit) : "no limit");
}

std::string row_text(const Mishap& mishap, std::size_t which_limit, bool is_noisy,
                     const Seen& seen) {
  std::string text = fmt::format(
      "peaks {:.2f} rad/s, {:.2f} rad/s2; path error p50 {:.4f}, p99 {:.4f}, largest {:.4f} rad; "
      "passed over {:.1f} %; holding {:.2f} %",
      seen.peak_velocity, seen.peak_acceleration, seen.error(0.5), seen.error(0.99), seen.error(1),
      100 * static_cast<double>(seen.passed_over) / static_cast<double>(seen.knots),
      100 * seen.holding);
  if (is_noisy || which_limit >= mishap.simulated.size()) return text;
  const auto [p99, largest] = mishap.simulated[which_limit];
  if (p99 > 0) text += fmt::format(" (design: p99 {}, largest {})", p99, largest);
  return text;
}

}  // namespace

Result run_motions(const CampaignOptions& options) {
  const ipc::MonotonicClock clock;
  const Time begin = clock.now();
  MotionFindings findings;
  nlohmann::json measured;
  std::uint64_t rows = 0;
  const Sines motion(options.seed);
  for (const Mishap& mishap : mishaps()) {
    for (const bool is_noisy : {false, true}) {
      for (std::size_t i = 0; i < kLimits.size(); ++i) {
        constexpr double kNoise = 1e-4;
        Trial trial(motion, mishap.make(motion, options.seed), kLimits[i], is_noisy ? kNoise : 0,
                    options.seed);
        const Seen seen = trial.run();
        judge(mishap, kLimits[i], is_noisy, seen, findings);
        measured[row_name(mishap, kLimits[i], is_noisy)] = row_text(mishap, i, is_noisy, seen);
        ++rows;
      }
    }
  }
  return {.json = {{"promise", {2, 4, 5}},
                   {"attack",
                    "a motion of six joints whose producer is late, silent, dead or of another "
                    "mind, with limits and without, in simulated time through the real ring, "
                    "solver, board and sampler"},
                   {"count", rows},
                   {"unit", "runs of 20 s"},
                   {"found", findings.json()},
                   {"measured", std::move(measured)},
                   {"machine", this_machine()},
                   {"seconds", core::to_seconds(clock.now() - begin)},
                   {"command", options.command},
                   {"version", apps::kVersion},
                   {"build", this_build()}},
          .is_sound = findings.is_sound()};
}

}  // namespace splinecast::campaign
