#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/ring/writer.hpp"
#include "ipc/sampling/sampler.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/campaign/motions/sines.hpp"
#include "tests/campaign/streams/plan.hpp"
#include "tests/campaign/streams/random.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::campaign {
namespace {

using std::chrono::milliseconds;

constexpr Time kBegin{1'000'000'000'000};
constexpr Time kTick = milliseconds(1);
/// End of the last fault. The motion is defined for Sines::kSeconds.
constexpr Time kLastFault = std::chrono::seconds(10);
constexpr Time kEnd = std::chrono::seconds(19);

Time to_time(double seconds) { return Time(std::llround(seconds * 1e9)); }

/// Counters over all runs.
struct ReturnCounts {
  std::uint64_t runs = 0;
  std::uint64_t silences = 0;
  std::uint64_t delays = 0;
  std::uint64_t replacements = 0;
  std::uint64_t takeovers = 0;
  std::uint64_t starvations = 0;
  std::uint64_t passed_over = 0;
  std::uint64_t late_returns = 0;
  std::uint64_t never_back = 0;
  std::uint64_t off_path = 0;
  std::vector<double> shares;  ///< time of the last return over the time allowed
};

/// The least acceleration of a two-phase motion that covers the distance `way` in `time`, with the
/// velocities `from` at its start and `to` at its end.
double two_phase_acceleration(double way, double from, double to, double time) {
  const double beside = std::abs(way - (from + to) / 2 * time);
  const double change = to - from;
  return (2 * beside + std::sqrt(4 * beside * beside + time * time * change * change)) /
         (time * time);
}

/// One stream in plain memory with faults until kLastFault.
class ReturnRun {
 public:
  ReturnRun(std::uint64_t seed, Beyond beyond, ReturnCounts& counts)
      : seed_(seed),
        random_(seed),
        counts_(&counts),
        motion_(seed % kMotions + 1),
        dimensions_(1 + random_.below(Sines::kJoints)),
        interval_(to_time(random_.log_uniform(0.004, 0.05))),
        limit_(Sines::kPeakAcceleration * random_.log_uniform(2, 15)),
        stream_(dimensions_, window(), 4096, 1024, {}, {}, ipc::LiveOptions{}),
        sampler_(stream_.board.reader, StreamClock::monotonic),
        state_(dimensions_) {
    const double settle = to_seconds(interval_) * 3 + 0.01;
    stream_.beyond = beyond;
    stream_.replace_solver();
    lead_ = to_time(settle + random_.uniform(0, 0.3));
    plan_faults();
  }

  void run() {
    ++counts_->runs;
    while (now_ < kEnd) {
      stream_.clock.time = kBegin + now_;
      if (now_ >= kLastFault && !allowed_ && !is_silent()) measure_distance();
      if (!is_silent()) produce();
      if (!is_dead()) solve();
      look();
      now_ += kTick;
    }
    judge();
  }

 private:
  static constexpr std::uint64_t kMotions = 500;

  enum class Fault { silence, delay, replacement, death };
  struct Planned {
    Fault kind{};
    Time from{};
    Time until{};
  };

  core::WindowOptions window() {
    constexpr std::array<const char*, 5> kMethods{"c2", "c2", "bessel", "makima", "smoothing"};
    core::WindowOptions how;
    how.interpolant.method = find_method(kMethods[random_.below(kMethods.size())]);
    how.settle = core::default_settle(*how.interpolant.method);
    if (how.interpolant.method->smooths()) {
      how.interpolant.lambda = 1e-12;
      how.settle = 8;
      how.accepts_short_lag = true;
    }
    how.start = {.kind = ConditionKind::halt, .value = {}};
    how.held_before_start = true;
    how.limits.acceleration.assign(dimensions_, limit_);
    return how;
  }

  /// One to four faults in the first seconds, and a last one that ends at kLastFault.
  void plan_faults() {
    Time t = std::chrono::seconds(2);
    for (std::size_t i = 1 + random_.below(4); i > 0; --i) {
      const Time length = to_time(random_.log_uniform(0.01, 0.8));
      faults_.push_back({static_cast<Fault>(random_.below(4)), t, t + length});
      t += to_time(random_.uniform(1, 2));
    }
    const Time length = to_time(random_.log_uniform(0.05, 1));
    const Fault last = random_.chance(0.7) ? Fault::silence : Fault::death;
    faults_.push_back({last, kLastFault - length, kLastFault});
    for (const Planned& fault : faults_) {
      counts_->silences += fault.kind == Fault::silence ? 1U : 0U;
      counts_->delays += fault.kind == Fault::delay ? 1U : 0U;
    }
  }
  [[nodiscard]] bool is_in(Fault kind) const {
    return std::ranges::any_of(faults_, [&](const Planned& fault) {
      return fault.kind == kind && now_ >= fault.from && now_ < fault.until;
    });
  }
  [[nodiscard]] bool is_silent() const { return is_in(Fault::silence); }
  [[nodiscard]] bool is_dead() const { return is_in(Fault::death); }

  [[nodiscard]] std::vector<double> positions(Time t) const {
    std::vector<double> all = motion_.positions(to_seconds(t));
    all.resize(dimensions_);
    return all;
  }
  [[nodiscard]] ipc::WaypointRingWriter::Solved solved() const {
    return {.consumed = stream_.board.reader.consumed(),
            .settled_until = stream_.board.reader.look().settled_until,
            .clock = &stream_.clock};
  }

  void produce() {
    for (Planned& fault : faults_) {
      if (fault.kind != Fault::replacement || now_ < fault.from) continue;
      fault.from = Time::max();
      replace();
    }
    const bool is_late = is_in(Fault::delay);
    const Time lead = is_late ? std::min<Time>(lead_, milliseconds(8)) : lead_;
    for (; next_ <= now_ + lead && next_ < kEnd + lead_; next_ += interval_) {
      const auto position = positions(next_);
      const auto status =
          stream_.ring.writer.append({.time = kBegin + next_, .position = position}, solved());
      if (status == AppendStatus::full) return;
    }
  }
  /// Replaces the future by the same motion, with shifted waypoint times.
  void replace() {
    const Time from = now_ + milliseconds(10);
    std::vector<std::vector<double>> values;
    std::vector<Waypoint> waypoints;
    for (Time t = from + interval_; t < next_; t += interval_) values.push_back(positions(t));
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Time t = from + interval_ * static_cast<std::int64_t>(i + 1);
      waypoints.push_back({.time = kBegin + t, .position = values[i]});
    }
    if (waypoints.empty()) return;
    const Time blend = random_.chance(0.5) ? to_time(random_.uniform(0, 0.3)) : Time(0);
    const auto status = stream_.ring.writer.replace_from(kBegin + from, waypoints, solved(), blend);
    if (status != AppendStatus::accepted) return;
    ++counts_->replacements;
    next_ = waypoints.back().time - kBegin + interval_;
  }

  void solve() {
    constexpr int kMostSteps = 8;
    if (was_dead_) {
      stream_.replace_solver();
      ++counts_->takeovers;
    }
    was_dead_ = false;
    for (int i = 0; i < kMostSteps; ++i) {
      const auto result = stream_.solver.step(stream_.clock);
      if (result.consumed == 0 && stream_.solver.due() > stream_.clock.time) return;
    }
  }

  /// Sets the allowed time from the end of the last fault: twice the least time in which a
  /// two-phase motion reaches the path, plus 0.5 s.
  void measure_distance() {
    constexpr Time kLook = milliseconds(5);
    constexpr double kAllowance = 0.5;
    if (!has_values(sampler_.preview(kBegin + now_, state_.ref()))) return;
    Time least = kLook;
    while (now_ + least < kEnd && !reaches_path(to_seconds(least))) least += kLook;
    allowed_ = 2 * least + to_time(kAllowance);
  }
  [[nodiscard]] bool reaches_path(double time) const {
    const double t = to_seconds(now_) + time;
    for (std::size_t d = 0; d < dimensions_; ++d) {
      const double needed = two_phase_acceleration(motion_.at(d, t) - state_.position()[d],
                                                   state_.velocity()[d], motion_.at(d, t, 1), time);
      if (needed > limit_) return false;
    }
    return true;
  }

  /// Records the time since which the curve has been on its waypoints without interruption.
  void look() {
    was_dead_ = was_dead_ || is_dead();
    const ipc::Summary& summary = stream_.solver.summary();
    const auto course = static_cast<ipc::Course>(summary.course);
    const bool is_on_target = course == ipc::Course::on_target && !summary.starved && !is_dead();
    if (!is_on_target) back_at_.reset();
    if (is_on_target && !back_at_) back_at_ = now_;
  }

  void judge() {
    const ipc::Summary& summary = stream_.solver.summary();
    counts_->starvations += summary.underruns;
    counts_->passed_over += summary.passed_over;
    // The return must be in time, and the curve on the path at the end.
    if (!back_at_ || !allowed_) {
      ++counts_->never_back;
      return notify("never back on the waypoints");
    }
    const Time taken = std::max(Time(0), *back_at_ - kLastFault);
    const double share = to_seconds(taken) / to_seconds(*allowed_);
    counts_->shares.push_back(share);
    if (share > 1) {
      ++counts_->late_returns;
      notify(fmt::format("back after {:.3f} s, allowed: {:.3f} s", to_seconds(taken),
                         to_seconds(*allowed_)));
    }
    const Time at = kEnd - lead_;
    constexpr double kNear = 1e-3;
    if (!has_values(sampler_.preview(kBegin + at, state_.ref()))) return;
    for (std::size_t d = 0; d < dimensions_; ++d) {
      const double error = state_.position()[d] - motion_.at(d, to_seconds(at));
      if (std::abs(error) < kNear) continue;
      ++counts_->off_path;
      return notify(fmt::format("{} rad off the path at the end", error));
    }
  }
  void notify(const std::string& what) const {
    apps::say(fmt::format("seed {} ({}, {:.1f} ms, lead {:.0f} ms, limit {:.1f}): {}", seed_,
                          stream_.window.interpolant.method->name, to_seconds(interval_) * 1e3,
                          to_seconds(lead_) * 1e3, limit_, what));
  }

  std::uint64_t seed_;
  Random random_;
  ReturnCounts* counts_;
  Sines motion_;
  std::size_t dimensions_;
  Time interval_;
  Time lead_{};
  double limit_;
  testing::MemoryStream stream_;
  ipc::Sampler sampler_;
  State state_;
  std::vector<Planned> faults_;
  Time now_ = milliseconds(-300);
  Time next_{};
  bool was_dead_ = false;
  std::optional<Time> allowed_;
  std::optional<Time> back_at_;
};

double quantile(std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0;
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

Result run_returns(const CampaignOptions& options) {
  const MonotonicClock clock;
  const Time begin = clock.now();
  ReturnCounts counts;
  const auto continues = [&] {
    return options.runs > 0 ? counts.runs < options.runs : cpu_seconds() < options.seconds;
  };
  for (std::uint64_t seed = options.seed; continues() && !apps::stop_requested(); ++seed) {
    ReturnRun(seed, options.beyond, counts).run();
  }
  std::ranges::sort(counts.shares);
  const std::uint64_t never_tried =
      static_cast<std::uint64_t>(counts.silences == 0) + (counts.delays == 0 ? 1 : 0) +
      (counts.replacements == 0 ? 1 : 0) + (counts.takeovers == 0 ? 1 : 0) +
      (counts.starvations == 0 ? 1 : 0) + (counts.passed_over == 0 ? 1 : 0);
  const nlohmann::json found{{"returns later than allowed", counts.late_returns},
                             {"streams that never returned", counts.never_back},
                             {"streams off their path at the end", counts.off_path},
                             {"required events that never happened", never_tried}};
  const nlohmann::json measured{
      {"simulated seconds", static_cast<double>(counts.runs) * to_seconds(kEnd)},
      {"silences", counts.silences},
      {"delays", counts.delays},
      {"replacements", counts.replacements},
      {"takeovers", counts.takeovers},
      {"starvations", counts.starvations},
      {"waypoints passed over", counts.passed_over},
      {"return time / allowed time, p50", quantile(counts.shares, 0.5)},
      {"return time / allowed time, p99", quantile(counts.shares, 0.99)},
      {"return time / allowed time, largest", quantile(counts.shares, 1)}};
  return make_result(
      options, 10,
      "returns: motions with random intervals, leads, limits and methods, whose producers "
      "are silent, late or replan, and whose solvers die; after the last fault, the "
      "return to the waypoints takes at most twice the least time of a two-phase "
      "motion under the same limits, plus 0.5 s",
      counts.runs, "returns", found, measured, to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
