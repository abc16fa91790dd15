#include "ipc/options/curve.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/forms/stop.hpp"
#include "core/limits/named.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/limits.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

constexpr std::size_t kDefaultCapacity = 4096;
constexpr Time kDefaultStopTime = std::chrono::milliseconds(250);
/// Upper bounds of freeze-ahead and history, beyond any practical value.
constexpr Time kLongestFreeze = std::chrono::minutes(1);
constexpr Time kLongestHistory = std::chrono::hours(24);
template <typename T>
void require_same(const std::string& stream, const char* what, const std::optional<T>& wanted,
                  const T& stands, const std::string& wanted_text, const std::string& stands_text) {
  if (!wanted || *wanted == stands) return;
  throw BadRequest("stream '" + stream + "' is solved with " + what + ' ' + stands_text + ", not " +
                   wanted_text + "; 'splinecast rm " + stream + "' removes it");
}

const Method& method_of(const SolverOptions& options) {
  return options.method == nullptr ? c2() : *options.method;
}

/// Throws BadRequest if a given limit differs from that of the board. Does not compare kinds of
/// limits that are not given.
void require_same_limits(const std::string& stream, const RegionHeader& stands,
                         const SolverOptions& options) {
  const MotionLimits limits = limits_for(options, stands);
  const MotionLimits stood = motion_limits(stands);
  const auto compare = [&](const char* what, const std::vector<double>& wanted,
                           const std::vector<double>& there, double none) {
    const auto at = [none](const std::vector<double>& values, std::size_t d) {
      return values.empty() ? none : values[d];
    };
    const auto text = [none](double value) {
      return value == none ? std::string("none") : std::to_string(value);
    };
    for (std::size_t d = 0; d < wanted.size(); ++d) {
      require_same(stream, what, std::optional(wanted[d]), at(there, d), text(wanted[d]),
                   text(at(there, d)));
    }
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  compare("velocity limit", limits.velocity, stood.velocity, 0);
  compare("acceleration limit", limits.acceleration, stood.acceleration, 0);
  compare("jerk limit", limits.jerk, stood.jerk, 0);
  compare("lower bound", limits.lower, stood.lower, -kInfinity);
  compare("upper bound", limits.upper, stood.upper, kInfinity);
}

void require_same_times(const std::string& stream, const RegionHeader& stands,
                        const SolverOptions& options) {
  const auto compare = [&](const char* what, const std::optional<Time>& wanted,
                           std::int64_t stood) {
    require_same(stream, what, wanted, Time(stood),
                 std::to_string(wanted.value_or(Time(stood)).count()), std::to_string(stood));
  };
  compare("stop time in ns", options.stop_time, stands.stop_time);
  compare("freeze-ahead in ns", options.freeze_ahead, stands.freeze_ahead);
  compare("history in ns", options.history, stands.history);
  compare("shortest entry in ns", options.min_entry, stands.min_entry);
}

void require_time(const char* what, const std::optional<Time>& time, Time least, Time most) {
  if (!time || (*time >= least && *time <= most)) return;
  throw BadRequest(std::string(what) + " must be " + std::to_string(least.count()) + " to " +
                   std::to_string(most.count()) + " ns, not " + std::to_string(time->count()));
}

void require_times(const SolverOptions& options) {
  if (options.stop_time &&
      (*options.stop_time <= Time::zero() || *options.stop_time > kLongestStop)) {
    throw BadRequest("stop time must be positive and at most 2^60 ns, not " +
                     std::to_string(options.stop_time->count()) + " ns");
  }
  require_time("freeze-ahead", options.freeze_ahead, Time(1), kLongestFreeze);
  require_time("history", options.history, Time::zero(), kLongestHistory);
  require_time("shortest entry", options.min_entry, Time(1), kLongestFreeze);
}

void require_rate(const std::optional<double>& rate) {
  if (!rate || (*rate > 0 && *rate <= kLargestRate)) return;
  throw BadRequest("largest rate must be above 0 and at most 100, not " + std::to_string(*rate));
}

/// Checks the options that only some methods have.
void require_parameters_of(const Method& method, const SolverOptions& options) {
  if (method.smooths() && !options.lambda) {
    throw BadRequest("method smoothing needs a lambda: it cannot be chosen online");
  }
  if (options.lambda && !method.smooths()) {
    throw BadRequest("lambda is for method smoothing, not for " + std::string(method.name));
  }
  if (options.force_lag && !method.smooths()) {
    throw BadRequest("the lag can be forced only for method smoothing, not for " +
                     std::string(method.name));
  }
  if (options.time_scale && method.laws.is_scale_free) {
    throw BadRequest("the time scale is for method rounded, not for " + std::string(method.name));
  }
  if (options.tail && method.has_own_tail()) {
    throw BadRequest("the tail of method " + std::string(method.name) + " is fixed, not '" +
                     std::string(to_string(*options.tail)) + "'");
  }
}

/// What the solver does with a waypoint beyond a limit. A curve that may leave its spline at any
/// time needs a clock.
Beyond beyond_for(const SolverOptions& options, const RegionHeader& header) {
  const Beyond beyond = options.beyond.value_or(Beyond::report);
  if (beyond == Beyond::enter && !is_live(stream_clock(header))) {
    throw BadRequest(
        "beyond 'enter' is for live streams: a recorded stream takes report or refuse");
  }
  return beyond;
}

}  // namespace

void require_options(const SolverOptions& options) {
  require_times(options);
  require_rate(options.largest_rate);
  require_parameters_of(method_of(options), options);
  // Checks with one dimension and without limits: the stream's dimensions are not known yet.
  SolverOptions curve = options;
  curve.limits.reset();
  curve.named_limits.clear();
  curve.beyond.reset();
  RegionHeader header{};
  header.dimensions = 1;
  write_options(curve, header);
  try {
    if (options.limits) require_limits(*options.limits);
    (void)core::SlidingWindow(1, window_options(header));
  } catch (const std::invalid_argument& error) {
    throw BadRequest(error.what());
  }
  const std::size_t least = StreamSolver::min_capacity(header.settle);
  if (options.capacity && (*options.capacity < least || *options.capacity > kMaxBoardCapacity)) {
    throw BadRequest("capacity must be " + std::to_string(least) + " to " +
                     std::to_string(kMaxBoardCapacity) + " segments, not " +
                     std::to_string(*options.capacity));
  }
}

void write_options(const SolverOptions& options, RegionHeader& header) {
  const Method& method = method_of(options);
  header.method = method.number;
  header.lambda = options.lambda.value_or(0.0);
  header.time_scale = options.time_scale.value_or(1.0);
  header.settle = options.settle.value_or(core::default_settle(method));
  header.tail = static_cast<std::uint64_t>(options.tail.value_or(Tail::bessel));
  const MotionLimits limits = limits_for(options, header);
  header.stop_time = options.stop_time.value_or(kDefaultStopTime).count();
  put_limits(limits, header);
  header.beyond = static_cast<std::uint64_t>(beyond_for(options, header));
  const LiveOptions live;
  const Time freeze_ahead = options.freeze_ahead.value_or(live.freeze_ahead);
  header.freeze_ahead = freeze_ahead.count();
  header.history = options.history.value_or(live.history).count();
  header.min_entry = options.min_entry.value_or(freeze_ahead).count();
  header.force_lag = options.force_lag ? 1 : 0;
  header.rules = kRules;
  header.capacity = std::bit_ceil(options.capacity.value_or(kDefaultCapacity));
}

std::optional<LiveOptions> live_options(const RegionHeader& header) noexcept {
  if (!is_live(stream_clock(header))) return std::nullopt;
  return LiveOptions{.freeze_ahead = Time(header.freeze_ahead),
                     .history = Time(header.history),
                     .min_entry = Time(header.min_entry),
                     .follows_law = stream_clock(header) == StreamClock::law};
}

namespace {

/// The largest rate of the law that a stream follows; 1 if it follows none, or if an earlier
/// version has recorded it.
double rate_of_law(const RegionHeader& header) noexcept {
  return header.law_id != 0 && header.largest_rate > 0 ? header.largest_rate : 1;
}

}  // namespace

core::WindowOptions window_options(const RegionHeader& header) {
  return {.interpolant = {.method = find_method(header.method),
                          .lambda = header.lambda,
                          .time_scale = header.time_scale},
          .settle = header.settle,
          .tail = static_cast<Tail>(header.tail),
          .start = start_condition(header),
          .stop_time = Time(header.stop_time),
          .limits = motion_limits(header),
          .largest_rate = rate_of_law(header),
          .held_before_start = is_live(stream_clock(header)),
          .force_lag = header.force_lag != 0};
}

MotionLimits limits_for(const SolverOptions& options, const RegionHeader& header) {
  std::vector<NamedLimits> named = options.named_limits;
  for (NamedLimits& joint : named) joint.name = header_name(joint.name);
  try {
    const MotionLimits given = spread(options.limits.value_or(MotionLimits{}), header.dimensions);
    MotionLimits limits = core::overridden(core::matched(named, dimension_names(header)), given);
    require_limits(limits, dimensions_of(header));
    return limits;
  } catch (const std::invalid_argument& error) {
    throw BadRequest(error.what());
  }
}

void require_same_options(const std::string& stream, const RegionHeader& stands,
                          const SolverOptions& options) {
  const auto number = [](auto value) { return std::to_string(value); };
  require_same(stream, "rules", std::optional(kRules), stands.rules, number(kRules),
               number(stands.rules));
  const Method* const method = find_method(stands.method);
  if (options.method != nullptr) {
    require_same<const Method*>(stream, "method", options.method, method,
                                std::string(options.method->name), std::string(method->name));
  }
  require_same(stream, "lambda", options.lambda, stands.lambda, number(options.lambda.value_or(0)),
               number(stands.lambda));
  require_same(stream, "time scale", options.time_scale, stands.time_scale,
               number(options.time_scale.value_or(0)), number(stands.time_scale));
  require_same<std::size_t>(stream, "settle lag", options.settle, stands.settle,
                            number(options.settle.value_or(0)), number(stands.settle));
  const auto tail = static_cast<Tail>(stands.tail);
  require_same(stream, "tail", options.tail, tail,
               std::string(to_string(options.tail.value_or(tail))), std::string(to_string(tail)));
  require_same_times(stream, stands, options);
  require_same_limits(stream, stands, options);
  if (options.beyond) {
    require_same<std::uint64_t>(stream, "action beyond the limits (0 report, 1 refuse, 2 enter)",
                                static_cast<std::uint64_t>(*options.beyond), stands.beyond,
                                number(static_cast<int>(*options.beyond)), number(stands.beyond));
  }
  const auto largest_rate = stands.is_law != 0 ? options.largest_rate : std::nullopt;
  require_same(stream, "largest rate", largest_rate, stands.largest_rate,
               number(largest_rate.value_or(0)), number(stands.largest_rate));
  if (options.capacity) {
    require_same<std::size_t>(stream, "capacity", std::bit_ceil(*options.capacity), stands.capacity,
                              number(*options.capacity), number(stands.capacity));
  }
}

}  // namespace splinecast::ipc
