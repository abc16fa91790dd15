#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "core/limits/check.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/ring/writer.hpp"
#include "ipc/sampling/sampler.hpp"
#include "ipc/verification/settled_segments.hpp"
#include "tests/campaign/campaigns.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::campaign {
namespace {

using std::chrono::milliseconds;

constexpr Time kStart{1'000'000'000'000};
constexpr Time kInterval = milliseconds(10);
constexpr Time kLead = milliseconds(200);
constexpr Time kPlayed = std::chrono::seconds(20);
/// A curve may meet no waypoint for this long without saying so: until it says so, plus the longest
/// entry to one and the lead.
constexpr Time kSilent = ipc::kUnmetReported + core::EntrySearch::kLongest + kLead;

/// Waypoints of one dimension that a curve within the limits cannot all meet.
struct Source {
  const char* name;
  double (*position)(double t);
  double velocity_limit;
  double acceleration_limit;
  double noise = 0;   ///< standard deviation
  double lambda = 0;  ///< of `smoothing`; 0: the method is c2
};

double slow_sine(double t) { return 0.5 * (1 - std::cos(t)); }
double step(double t) { return slow_sine(t) + (t >= 8 ? 0.3 : 0); }
double steps(double t) { return slow_sine(t) + 0.3 * std::floor(t / 2); }
double square(double t) { return std::fmod(t, 0.4) < 0.2 ? 0 : 0.3; }
double ramp(double t) { return 3.6 * t; }
double sine_of(double velocity, double acceleration, double t) {
  const double rate = acceleration / velocity;
  return velocity / rate * (1 - std::cos(rate * t));
}

std::vector<Source> sources() {
  const auto fast = [](double t) { return sine_of(3.6, 3.6, t); };
  const auto hard = [](double t) { return sine_of(2, 15, t); };
  return {{"slow sine", slow_sine, 3, 10},
          {"noise 0.03 mm", slow_sine, 3, 10, 3e-5},
          {"noise 0.1 mm", slow_sine, 3, 10, 1e-4},
          {"noise 0.3 mm", slow_sine, 3, 10, 3e-4},
          {"noise 1 mm", slow_sine, 3, 10, 1e-3},
          {"noise 1 mm, smoothed", slow_sine, 3, 10, 1e-3, 1e-6},
          {"noise 100 mm", slow_sine, 3, 10, 0.1},
          {"sine with a = 1.5 A", hard, 3, 10},
          {"sine with v = 1.2 V", fast, 3, 10},
          {"line with v = 1.2 V", ramp, 3, 10},
          {"one step of 0.3", step, 2.5, 12},
          {"steps of 0.3 every 2 s", steps, 2.5, 12},
          {"square of 0.3, 2.5 Hz", square, 2.5, 12}};
}

/// What became of the waypoints of a source, and of the curve.
struct Followed {
  std::uint64_t sent = 0;
  std::uint64_t not_sent = 0;  ///< refused by the producer
  ipc::Summary summary{};
  std::vector<double> errors{};  ///< of a 1 kHz reader from 2 s on; sorted at the end
  double velocity = 0;           ///< the largest of the settled curve, exactly
  double acceleration = 0;
  std::uint64_t beyond = 0;  ///< settled segments that exceed a limit
  std::uint64_t unsaid =
      0;  ///< looks at a curve that has met none for kSilent and has said nothing
  std::uint64_t reported_none = 0;
  std::uint64_t reported_cannot = 0;
  std::uint64_t unaccounted = 0;
};

/// One live stream in plain memory and simulated time. With `takes_over`, another solver takes over
/// at random times.
class FollowRun {
 public:
  FollowRun(const Source& source, Beyond beyond, std::uint64_t seed, bool takes_over)
      : source_(source),
        random_(seed),
        takes_over_(takes_over),
        stream_(1, window(source), 1024, 4096, {}, {}, ipc::LiveOptions{}),
        sampler_(stream_.board.reader, StreamClock::monotonic),
        settled_(stream_.board.reader, true),
        state_(1) {
    stream_.beyond = beyond;
    stream_.replace_solver();
  }

  Followed run() {
    for (Time now = -2 * kLead; now < kPlayed; now += milliseconds(1)) {
      stream_.clock.time = kStart + now;
      for (; next_ <= now + kLead; next_ += kInterval) send(next_);
      if (takes_over_ && std::bernoulli_distribution(0.01)(random_)) stream_.replace_solver();
      solve();
      look(now);
    }
    std::ranges::sort(seen_.errors);
    return std::move(seen_);
  }

 private:
  static core::WindowOptions window(const Source& source) {
    core::WindowOptions how;
    how.start = {.kind = ConditionKind::halt, .value = {}};
    how.held_before_start = true;
    how.limits.velocity = {source.velocity_limit};
    how.limits.acceleration = {source.acceleration_limit};
    if (source.lambda > 0) {
      how.interpolant = {.method = find_method("smoothing"), .lambda = source.lambda};
      how.accepts_short_lag = true;
    }
    return how;
  }

  void send(Time t) {
    double x = source_.position(to_seconds(t));
    if (source_.noise > 0) x += std::normal_distribution<>(0, source_.noise)(random_);
    const ipc::Look look = stream_.board.reader.look();
    const auto status = stream_.ring.writer.append(
        {.time = kStart + t, .position = {&x, 1}},
        {.consumed = stream_.board.reader.consumed(),
         .settled_until = look.settled_until,
         .clock = &stream_.clock,
         .refused_until = stream_.board.reader.refused_until(look.revision)});
    ++(status == AppendStatus::accepted ? seen_.sent : seen_.not_sent);
  }

  void solve() {
    constexpr int kStepsPerMillisecond = 8;
    for (int i = 0; i < kStepsPerMillisecond; ++i) {
      const auto result = stream_.solver.step(stream_.clock);
      if (result.consumed == 0 && stream_.solver.due() > stream_.clock.time) return;
    }
  }

  void look(Time now) {
    seen_.summary = stream_.solver.summary();
    const ipc::Summary& summary = seen_.summary;
    const ipc::Word controls = summary.withdrawn + summary.controls;
    if (summary.consumed != summary.knots + summary.refused + controls) ++seen_.unaccounted;
    const ipc::Following now_following = summary.following();
    if (now_following != following_) {
      seen_.reported_none += now_following == ipc::Following::meets_none ? 1U : 0U;
      seen_.reported_cannot += now_following == ipc::Following::cannot_follow ? 1U : 0U;
    }
    following_ = now_following;
    look_at_segments();
    if (following_ != ipc::Following::meets) met_ = std::max(met_, stream_.clock.time);
    if (now > Time(0) && stream_.clock.time - met_ > kSilent) ++seen_.unsaid;
    constexpr double kErrorsFrom = 2;
    const double t = to_seconds(now);
    if (t < kErrorsFrom || !has_values(sampler_.sample(stream_.clock.time, state_))) return;
    seen_.errors.push_back(std::abs(state_.position()[0] - source_.position(t)));
  }

  /// Compares each segment that has settled since the last look with the limits.
  void look_at_segments() {
    settled_.look();
    const auto segments = settled_.segments();
    for (; segment_ < segments.size(); ++segment_) {
      const ipc::SegmentCopy& segment = segments[segment_];
      if (segment.has_waypoint) met_ = std::max(met_, segment.left);
      const core::SegmentPart part{.order = segment.order,
                                   .coefficients = segment.coefficients,
                                   .dimensions = 1,
                                   .from = 0,
                                   .to = to_seconds(segment.right - segment.left)};
      const MotionLimits& limits = stream_.window.limits;
      const auto worst = core::worst_excesses(limits, nullptr, part);
      const auto largest = [&](LimitKind kind) {
        return std::abs(worst.at(static_cast<std::size_t>(kind)).value);
      };
      seen_.velocity = std::max(seen_.velocity, largest(LimitKind::velocity));
      seen_.acceleration = std::max(seen_.acceleration, largest(LimitKind::acceleration));
      seen_.beyond += core::keeps_within(limits, nullptr, part) ? 0U : 1U;
    }
  }

  const Source& source_;
  std::mt19937_64 random_;
  bool takes_over_;
  testing::MemoryStream stream_;
  ipc::Sampler sampler_;
  ipc::SettledSegments settled_;
  State state_;
  Followed seen_;
  ipc::Following following_{};
  std::size_t segment_ = 0;
  Time next_{};
  Time met_ = kStart;  ///< of the last waypoint met, or the last time that the curve met none
};

/// Text that page.py makes a column of.
std::string text_of(const Followed& seen) {
  const ipc::Summary& summary = seen.summary;
  const auto error = [&](double share) {
    if (seen.errors.empty()) return std::string("none");
    const auto last = static_cast<double>(seen.errors.size() - 1);
    return fmt::format("{:.3g} mm", 1e3 * seen.errors[static_cast<std::size_t>(share * last)]);
  };
  return fmt::format(
      "met: {}; passed over: {}; refused by the solver: {}; refused by the producer: {}; excesses: "
      "{}; reported that it meets none: {}; reported that it cannot follow: {}; path error p50: "
      "{}; path "
      "error p99: {}; largest path error: {}; peak velocity: {:.4g}; peak acceleration: {:.4g}",
      summary.interpolated(), summary.passed_over, summary.refused, seen.not_sent,
      summary.exceeding, seen.reported_none, seen.reported_cannot, error(0.5), error(0.99),
      error(1), seen.velocity, seen.acceleration);
}

/// Sums over all runs with Beyond::enter; accounts over all runs.
struct FollowFindings {
  std::uint64_t runs = 0;
  std::uint64_t beyond = 0;
  std::uint64_t unsaid = 0;
  std::uint64_t unaccounted = 0;
  std::uint64_t gave_up = 0;

  void add(const Source& source, Beyond beyond_what, std::uint64_t seed, const Followed& seen) {
    ++runs;
    unaccounted += seen.unaccounted;
    if (beyond_what != Beyond::enter) return;
    beyond += seen.beyond;
    unsaid += seen.unsaid;
    gave_up += seen.reported_cannot;
    if (seen.beyond + seen.unsaid == 0) return;
    apps::say(fmt::format("{}, seed {}: {} segments beyond a limit, {} looks at a silent curve",
                          source.name, seed, seen.beyond, seen.unsaid));
  }
  [[nodiscard]] nlohmann::json found() const {
    return {{"segments beyond a limit", beyond},
            {"looks at a curve that meets no waypoint and has not said so", unsaid},
            {"looks at wrong accounts", unaccounted},
            {"required events that never happened", gave_up == 0 ? 1 : 0}};
  }
};

}  // namespace

Result run_follow(const CampaignOptions& options) {
  const MonotonicClock clock;
  const Time begin = clock.now();
  FollowFindings findings;
  nlohmann::json measured;
  const std::uint64_t seeds = options.runs > 0 ? options.runs : 20;
  for (const Source& source : sources()) {
    for (const Beyond what : {Beyond::report, Beyond::refuse, Beyond::enter}) {
      const Followed seen = FollowRun(source, what, options.seed, false).run();
      findings.add(source, what, options.seed, seen);
      measured[fmt::format("{}, limits {} and {}; {}", source.name, source.velocity_limit,
                           source.acceleration_limit, to_string(what))] = text_of(seen);
    }
    for (std::uint64_t seed = options.seed + 1; seed < options.seed + seeds; ++seed) {
      if (apps::stop_requested()) break;
      const bool takes_over = seed % 2 == 0;
      const Followed seen = FollowRun(source, Beyond::enter, seed, takes_over).run();
      findings.add(source, Beyond::enter, seed, seen);
    }
  }
  return make_result(options, {10, 11},
                     "follow: sources that a curve within its limits cannot meet, at 100 Hz for "
                     "20 s, with `--beyond enter`, and takeovers at random times; the first run of "
                     "each source also with `report` and `refuse`",
                     findings.runs, "streams", findings.found(), measured,
                     to_seconds(clock.now() - begin));
}

}  // namespace splinecast::campaign
