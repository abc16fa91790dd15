#include "tests/campaign/streams/plan.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/forms/stop.hpp"
#include "core/solvers/smoothing_rows.hpp"
#include "splinecast/limits.hpp"
#include "tests/fixtures/curves/streaming_methods.hpp"

namespace splinecast::campaign {
namespace {

using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

constexpr std::size_t kMostDimensions = 9;
constexpr double kShareOfQuaternions = 0.3;
constexpr double kShareOfWraps = 0.3;

Time log_between(Random& random, Time low, Time high) {
  return Time(static_cast<std::int64_t>(
      random.log_uniform(static_cast<double>(low.count()), static_cast<double>(high.count()))));
}

std::vector<Dimension> make_dimensions(Random& random) {
  const std::size_t count = 1 + random.below(kMostDimensions);
  const bool all_linear = random.chance(0.5);
  std::vector<Dimension> dimensions;
  while (dimensions.size() < count) {
    if (all_linear) {
      dimensions.push_back({});
    } else if (count - dimensions.size() >= kQuaternionSize && random.chance(kShareOfQuaternions)) {
      const auto kind =
          random.chance(0.5) ? DimensionKind::quaternion : DimensionKind::quaternion_wxyz;
      dimensions.insert(dimensions.end(), kQuaternionSize, {.kind = kind});
    } else if (random.chance(kShareOfWraps)) {
      constexpr std::array kPeriods{1.0, 6.283185307179586, 360.0, 1e-6};
      dimensions.push_back(
          {.kind = DimensionKind::periodic, .period = kPeriods[random.below(kPeriods.size())]});
    } else {
      dimensions.push_back({});
    }
  }
  return dimensions;
}

Interpolant make_interpolant(std::uint64_t seed, Time interval, Random& random) {
  const auto& methods = testing::streaming_methods();
  Interpolant interpolant{.method = methods[seed % methods.size()]};
  interpolant.time_scale = random.log_uniform(1e-3, 1e3);
  const double h = to_seconds(interval);
  interpolant.lambda = random.chance(0.1) ? 0 : h * h * h * random.log_uniform(1e-3, 1e3);
  return interpolant;
}

std::size_t make_settle(const Interpolant& interpolant, Random& random, bool& forced) {
  const Method& method = *interpolant.method;
  if (random.chance(0.4)) return core::default_settle(method);
  if (method.smooths()) {
    forced = random.chance(0.3);
    const auto least = static_cast<std::size_t>(core::smoothing_lag(0, 1));
    return forced ? random.below(core::kMaxSettle + 1)
                  : least + random.below(core::kMaxSettle + 1 - least);
  }
  if (method.converges()) return random.below(17);
  return method.look_ahead + random.below(4);
}

Condition make_start(Random& random) {
  constexpr std::array kKinds{ConditionKind::clamped, ConditionKind::natural, ConditionKind::own};
  if (random.chance(0.8)) return {.kind = ConditionKind::halt, .value = {}};
  return {.kind = kKinds[random.below(kKinds.size())], .value = {}};
}

/// An end condition. Its values, if any, are small, and 0 in quaternions.
Condition make_end(const StreamPlan& plan, Random& random) {
  constexpr std::array kKinds{ConditionKind::clamped, ConditionKind::natural, ConditionKind::own,
                              ConditionKind::velocity, ConditionKind::acceleration};
  if (random.chance(0.6)) return {.kind = ConditionKind::halt, .value = {}};
  Condition end{.kind = kKinds[random.below(kKinds.size())], .value = {}};
  if (end.kind < ConditionKind::velocity || end.kind > ConditionKind::acceleration) {
    return end;
  }
  for (const Dimension& dimension : plan.dimensions) {
    const bool turns = dimension.kind >= DimensionKind::quaternion;
    end.value.push_back(turns ? 0 : plan.magnitude * random.uniform(-1, 1));
  }
  return end;
}

/// Limits of `times` times the motion's accelerations; some dimensions have no limit.
std::vector<double> make_limits(const StreamPlan& plan, double times, Random& random) {
  std::vector<double> limits;
  for (const Dimension& dimension : plan.dimensions) {
    double size = plan.magnitude;
    if (dimension.kind == DimensionKind::periodic) size = dimension.period;
    if (dimension.kind >= DimensionKind::quaternion) size = 1;
    const double limit = size * plan.frequency * plan.frequency * times;
    limits.push_back(random.chance(0.1) ? 0 : std::clamp(limit, 1e-90, 1e90));
  }
  return limits;
}

core::WindowOptions make_window(const StreamPlan& plan, Random& random) {
  core::WindowOptions window{.interpolant = make_interpolant(plan.seed, plan.interval, random)};
  window.settle = make_settle(window.interpolant, random, window.accepts_short_lag);
  constexpr std::array kTails{Tail::bessel, Tail::parabolic, Tail::natural, Tail::clamped};
  window.tail = kTails[random.below(kTails.size())];
  window.start = make_start(random);
  window.held_before_start = true;
  window.stop_length = log_between(random, milliseconds(5), seconds(1));
  if (plan.limit_class == LimitClass::none) return window;
  const bool is_tight = plan.limit_class == LimitClass::tight;
  window.stop_length = core::kLeastStopTime;
  window.limits.acceleration = make_limits(
      plan, is_tight ? random.log_uniform(0.5, 20) : random.log_uniform(100, 1e5), random);
  return window;
}

void choose_times(StreamPlan& plan, Random& random) {
  plan.begin = random.chance(0.1) ? Time(hours(24 * 365 * 50)) : Time(seconds(1000));
  plan.interval = log_between(random, microseconds(100), seconds(1));
  plan.length =
      std::max<Time>(plan.interval * (30 + static_cast<int>(random.below(400))), milliseconds(50));
  plan.tick = milliseconds(1);
  if (plan.length < seconds(2)) plan.tick = log_between(random, microseconds(50), milliseconds(2));
  const Time least = std::max<Time>(microseconds(500), plan.length / 20'000);
  plan.live.settle_ahead = log_between(random, least, std::max<Time>(least, milliseconds(50)));
  plan.live.least_entry =
      random.chance(0.5) ? plan.live.settle_ahead : random.part(plan.live.settle_ahead, 0.3, 3);
  plan.live.history =
      random.chance(0.2) ? Time(0) : log_between(random, milliseconds(5), seconds(1));
  if (random.chance(0.3)) plan.ingest.least = random.part(plan.interval, 0.1, 1);
  if (random.chance(0.3)) plan.ingest.most = random.part(plan.interval, 2, 30);
}

void choose_motion(StreamPlan& plan, Random& random) {
  plan.frequency = 1 / (to_seconds(plan.interval) * random.uniform(2, 30));
  plan.magnitude = random.log_uniform(1e-3, 1e3);
  if (random.chance(0.2)) plan.magnitude = random.log_uniform(1e-12, 1e12);
  if (random.chance(0.2)) plan.magnitude = random.log_uniform(1e-300, 1e90);
  if (random.chance(0.3)) plan.offset = random.uniform(-1000, 1000);
}

}  // namespace

StreamPlan make_plan(std::uint64_t seed, Random& random) {
  StreamPlan plan{.seed = seed, .dimensions = make_dimensions(random)};
  plan.kinds = DimensionKinds(plan.dimensions);
  choose_times(plan, random);
  choose_motion(plan, random);
  const double limits = random.unit();
  plan.limit_class = limits < 0.5    ? LimitClass::none
                     : limits < 0.75 ? LimitClass::generous
                                     : LimitClass::tight;
  plan.window = make_window(plan, random);
  plan.ring_capacity = std::size_t{2} << random.below(8);
  const std::size_t least = ipc::StreamSolver::min_capacity(plan.window.settle);
  plan.board_capacity = std::bit_ceil(least) << random.below(5);
  plan.step_trouble = random.chance(0.3) ? 0 : random.log_uniform(1e-3, 0.1);
  plan.starts_in_motion = random.chance(0.3);
  plan.end = make_end(plan, random);
  constexpr std::uint64_t kOneOf = 8;
  plan.beyond = seed % kOneOf == kOneOf / 2   ? Beyond::refuse
                : seed % kOneOf == kOneOf - 1 ? Beyond::enter
                                              : Beyond::report;
  return plan;
}

}  // namespace splinecast::campaign
