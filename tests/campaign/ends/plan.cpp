#include "tests/campaign/ends/plan.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "tests/campaign/streams/waypoint_source.hpp"
#include "tests/fixtures/curves/streaming_methods.hpp"

namespace splinecast::campaign::ends {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::array<std::string_view, kEndings> kEndingNames{
    "finish", "a stop", "a stop and a finish", "a replacement and a finish",
    "the death of the producer"};
constexpr std::array<std::string_view, kWhens> kWhenNames{
    "long before the last waypoint", "within the last segment", "in the stop", "at rest"};
constexpr std::array<std::string_view, kWalls> kWallNames{"no", "wide", "touched", "near",
                                                          "passed"};
constexpr double kInfinite = std::numeric_limits<double>::infinity();
/// Walls around a shorter way are those around one of this length.
constexpr double kLeastWay = 1e-6;

Time log_between(Random& random, Time low, Time high) {
  return Time(static_cast<std::int64_t>(
      random.log_uniform(static_cast<double>(low.count()), static_cast<double>(high.count()))));
}

std::vector<Dimension> make_dimensions(Random& random) {
  constexpr std::array<std::size_t, 8> kCounts{1, 1, 1, 1, 2, 2, 3, kMostDimensions};
  const std::size_t count = kCounts[random.below(kCounts.size())];
  std::vector<Dimension> dimensions(count);
  if (count == kMostDimensions && random.chance(0.7)) {
    const auto kind =
        random.chance(0.5) ? DimensionKind::quaternion : DimensionKind::quaternion_wxyz;
    std::fill_n(dimensions.begin() + static_cast<int>(random.below(3)), kQuaternionSize,
                Dimension{.kind = kind});
    return dimensions;
  }
  for (Dimension& dimension : dimensions) {
    if (random.chance(0.15)) {
      dimension = {.kind = DimensionKind::periodic, .period = random.chance(0.5) ? 6.28 : 1.0};
    }
  }
  return dimensions;
}

void choose_method(StreamPlan& plan, Random& random) {
  const auto& methods = testing::streaming_methods();
  Interpolant& interpolant = plan.window.interpolant;
  interpolant.method = random.chance(0.3) ? &c2() : methods[plan.seed % methods.size()];
  interpolant.time_scale = random.log_uniform(1e-2, 1e2);
  const double h = to_seconds(plan.interval);
  interpolant.lambda = h * h * h * random.log_uniform(1e-3, 1e1);
  const Method& method = *interpolant.method;
  plan.window.settle = method.smooths()     ? 8 + random.below(9)
                       : method.converges() ? 2 + random.below(8)
                                            : method.look_ahead + random.below(3);
  plan.window.accepts_short_lag = method.smooths();
  constexpr std::array kTails{Tail::bessel, Tail::bessel, Tail::parabolic, Tail::natural,
                              Tail::clamped};
  plan.window.tail = kTails[random.below(kTails.size())];
  plan.window.start = {.kind = ConditionKind::halt, .value = {}};
  plan.window.held_before_start = true;
  plan.window.stop_length = log_between(random, milliseconds(2), milliseconds(500));
}

void choose_times(StreamPlan& plan, Random& random) {
  plan.begin = seconds(1000);
  plan.interval = log_between(random, milliseconds(1), milliseconds(100));
  plan.live.settle_ahead = log_between(random, milliseconds(1), milliseconds(20));
  plan.live.least_entry =
      random.chance(0.5) ? plan.live.settle_ahead : random.part(plan.live.settle_ahead, 0.3, 3);
  plan.live.history =
      random.chance(0.3) ? Time(0) : log_between(random, milliseconds(5), seconds(1));
}

/// The condition of a finish. Its values are small, and 0 in quaternions.
Condition make_end(const StreamPlan& plan, Random& random) {
  constexpr std::array kKinds{ConditionKind::halt,     ConditionKind::halt,
                              ConditionKind::clamped,  ConditionKind::natural,
                              ConditionKind::velocity, ConditionKind::acceleration,
                              ConditionKind::own};
  Condition end{.kind = kKinds[random.below(kKinds.size())], .value = {}};
  if (end.kind != ConditionKind::velocity && end.kind != ConditionKind::acceleration) return end;
  const double v = plan.magnitude * plan.frequency;
  const double size = end.kind == ConditionKind::velocity ? v : v * plan.frequency;
  for (const Dimension& dimension : plan.dimensions) {
    const bool turns = dimension.kind >= DimensionKind::quaternion;
    end.value.push_back(turns || random.chance(0.3) ? 0 : size * random.uniform(-1, 1));
  }
  return end;
}

void make_motion(LifePlan& life, Random& random) {
  const StreamPlan& plan = life.stream;
  const std::size_t dimensions = plan.dimensions.size();
  WaypointSource source(plan, random);
  const bool is_rough = random.chance(0.15);
  if (is_rough) source.change_mode();
  const std::size_t count = 3 + random.below(random.chance(0.2) ? 60 : 20);
  const bool has_odd_end = random.chance(0.4);
  Time t = plan.begin + life.lead + plan.live.settle_ahead + milliseconds(1);
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_odd = i + 1 == count && has_odd_end;
    if (i > 0) t += is_odd ? log_between(random, microseconds(1), seconds(1)) : plan.interval;
    const Waypoint waypoint = is_rough ? source.at(t) : source.smooth_at(t);
    life.motion.times.push_back(t);
    auto& values = life.motion.values;
    for (const auto& part : {waypoint.position, waypoint.velocity, waypoint.acceleration}) {
      values.insert(values.end(), part.begin(), part.end());
      values.resize(values.size() + dimensions - part.size());
    }
  }
}

/// The largest absolute value of a derivative of the smooth motion: of a rotation, |ω| or |α|.
double peak_of(const LifePlan& life, std::size_t d, std::size_t derivative) {
  const auto& dimensions = life.stream.dimensions;
  double most = 0;
  for (std::size_t i = 0; i < life.motion.times.size(); ++i) {
    const auto values = life.motion.value(i, derivative, dimensions.size());
    if (dimensions[d].kind < DimensionKind::quaternion) {
      most = std::max(most, std::abs(values[d]));
      continue;
    }
    double squares = 0;
    for (const double x : values.subspan(d, kQuaternionSize)) squares += x * x;
    most = std::max(most, 2 * std::sqrt(squares));
  }
  return most;
}

void choose_limits(LifePlan& life, Random& random) {
  StreamPlan& plan = life.stream;
  const double which = random.unit();
  plan.limit_class = which < 0.25   ? LimitClass::none
                     : which < 0.45 ? LimitClass::generous
                                    : LimitClass::tight;
  if (plan.limit_class == LimitClass::none) return;
  const bool is_tight = plan.limit_class == LimitClass::tight;
  const double times = is_tight ? random.log_uniform(0.8, 6) : random.log_uniform(10, 1e3);
  MotionLimits& limits = plan.window.limits;
  const bool has_velocity = random.chance(0.4);
  const bool has_jerk = random.chance(0.3);
  const bool has_acceleration = random.chance(0.8) || !(has_velocity || has_jerk);
  for (std::size_t d = 0; d < plan.dimensions.size(); ++d) {
    const bool is_next = d > 0 && plan.dimensions[d].kind >= DimensionKind::quaternion &&
                         plan.dimensions[d - 1].kind == plan.dimensions[d].kind;
    const auto add = [&](std::vector<double>& list, bool has, double peak) {
      if (!has) return;
      list.push_back(is_next              ? list.back()
                     : random.chance(0.1) ? 0
                                          : std::clamp(peak * times, 1e-9, 1e12));
    };
    add(limits.velocity, has_velocity, peak_of(life, d, 1));
    add(limits.acceleration, has_acceleration, peak_of(life, d, 2));
    add(limits.jerk, has_jerk, peak_of(life, d, 2) * plan.frequency * random.log_uniform(1, 30));
  }
}

void choose_walls(LifePlan& life, Random& random) {
  StreamPlan& plan = life.stream;
  const std::size_t dimensions = plan.dimensions.size();
  const bool has_walls = random.chance(plan.limit_class == LimitClass::none ? 0.3 : 0.5);
  life.walls = has_walls ? static_cast<Walls>(1 + random.below(kWalls - 1)) : Walls::none;
  if (!has_walls) return;
  MotionLimits& limits = plan.window.limits;
  limits.lower.assign(dimensions, -kInfinite);
  limits.upper.assign(dimensions, kInfinite);
  const std::size_t count = life.motion.times.size();
  for (std::size_t d = 0; d < dimensions; ++d) {
    if (plan.dimensions[d].kind != DimensionKind::linear) continue;
    double least = life.motion.value(0, 0, dimensions)[d];
    double greatest = least;
    for (std::size_t i = 0; i < count; ++i) {
      least = std::min(least, life.motion.value(i, 0, dimensions)[d]);
      greatest = std::max(greatest, life.motion.value(i, 0, dimensions)[d]);
    }
    const double way = std::max(greatest - least, kLeastWay);
    const double last = life.motion.value(count - 1, 0, dimensions)[d];
    const bool rises = last >= life.motion.value(count - 2, 0, dimensions)[d];
    const bool moves = greatest - least >= kLeastWay;
    double margin = way * random.log_uniform(1, 100);
    if (life.walls == Walls::touched && moves) margin = random.chance(0.5) ? 0 : way * 1e-3;
    if (life.walls == Walls::passed && moves) margin = -way * random.uniform(0, 0.3);
    if (life.walls == Walls::near) {
      margin = way * random.log_uniform(1e-4, 0.3);
      (rises ? limits.upper : limits.lower)[d] =
          rises ? std::max(greatest, last) + margin : std::min(least, last) - margin;
      continue;
    }
    limits.lower[d] = least - margin;
    limits.upper[d] = greatest + margin;
  }
}

void choose_end(LifePlan& life, Random& random) {
  constexpr std::array kAll{
      Ending::finish, Ending::finish, Ending::finish, Ending::stop_then_finish,
      Ending::cancel, Ending::stop,   Ending::killed};
  StreamPlan& plan = life.stream;
  life.ending = kAll[random.below(kAll.size())];
  life.when = static_cast<When>(random.below(kWhens));
  const auto& times = life.motion.times;
  const Time last = times.back();
  const Time sent = last - life.lead;
  const Time ahead = plan.live.settle_ahead;
  switch (life.when) {
    case When::early:
      life.end_at = random.chance(0.5) ? sent : random.between(sent, std::max(sent, last));
      break;
    case When::last_segment:
      life.end_at = random.between(times[times.size() - 2] - ahead, last);
      break;
    case When::in_stop:
      life.end_at = random.between(last - ahead, last + plan.window.stop_length);
      break;
    case When::at_rest:
      life.end_at = last + plan.window.stop_length + random.part(ahead, 0, 20);
  }
  life.end_at = std::max(life.end_at, sent);
  life.finish_after = random.chance(0.3) ? Time(0) : random.part(ahead, 0, 30);
}

void choose_law(LifePlan& life, Random& random) {
  if (!random.chance(0.25)) return;
  life.stream.live.follows_law = true;
  life.rate = random.chance(0.3) ? 1 : random.log_uniform(0.1, 3);
  life.stream.window.max_rate = life.rate;
  if (!random.chance(0.5)) return;
  life.held_at = random.between(life.motion.times.front(), life.end_at + milliseconds(20));
  life.held_for = random.part(life.stream.live.settle_ahead, 1, 40);
}

}  // namespace

std::string_view to_string(Ending ending) noexcept {
  return kEndingNames[static_cast<std::size_t>(ending)];
}
std::string_view to_string(When when) noexcept {
  return kWhenNames[static_cast<std::size_t>(when)];
}
std::string_view to_string(Walls walls) noexcept {
  return kWallNames[static_cast<std::size_t>(walls)];
}

LifePlan make_life(std::uint64_t seed, Random& random) {
  LifePlan life{.stream = {.seed = seed, .dimensions = make_dimensions(random)}};
  StreamPlan& plan = life.stream;
  plan.kinds = DimensionKinds(plan.dimensions);
  choose_times(plan, random);
  choose_method(plan, random);
  plan.frequency = 1 / (to_seconds(plan.interval) * random.uniform(2, 30));
  plan.magnitude = random.log_uniform(1e-2, 1e2);
  life.lead = log_between(random, milliseconds(1), seconds(1));
  make_motion(life, random);
  choose_limits(life, random);
  choose_walls(life, random);
  choose_end(life, random);
  choose_law(life, random);
  plan.end = make_end(plan, random);
  plan.beyond = random.chance(0.3)   ? Beyond::refuse
                : random.chance(0.4) ? Beyond::enter
                                     : Beyond::report;
  plan.ring_capacity = 128;
  const std::size_t least = ipc::StreamSolver::min_capacity(plan.window.settle);
  plan.board_capacity = std::bit_ceil(std::max<std::size_t>(least, 64)) << random.below(2);
  life.takeover = random.chance(0.4) ? random.log_uniform(0.01, 0.3) : 0;
  return life;
}

}  // namespace splinecast::campaign::ends
