#include "ipc/options/curve.hpp"

#include <bit>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/forms/stop.hpp"
#include "core/limits/named.hpp"
#include "ipc/layout/limits.hpp"
#include "ipc/layout/options.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

template <typename T>
void require_same(const std::string& stream, std::string_view what, const std::optional<T>& wanted,
                  const T& existing, const std::string& wanted_text,
                  const std::string& found_text) {
  if (!wanted || *wanted == existing) return;
  throw BadRequest("stream '" + stream + "' is solved with " + std::string(what) + ' ' +
                   found_text + ", not " + wanted_text + "; 'splinecast rm " + stream +
                   "' removes it");
}

const Method& method_of(const SolverOptions& options) {
  return options.method == nullptr ? c2() : *options.method;
}

/// Throws BadRequest if a given limit differs from that of the board. Does not compare kinds of
/// limits that are not given.
void require_same_limits(const std::string& stream, const RegionHeader& existing,
                         const SolverOptions& options) {
  const MotionLimits limits = limits_for(options, existing);
  const MotionLimits found = motion_limits(existing);
  const auto compare = [&](std::string_view what, const std::vector<double>& wanted,
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
  compare("velocity limit", limits.velocity, found.velocity, 0);
  compare("acceleration limit", limits.acceleration, found.acceleration, 0);
  compare("jerk limit", limits.jerk, found.jerk, 0);
  compare("lower bound", limits.lower, found.lower, -kInfinity);
  compare("upper bound", limits.upper, found.upper, kInfinity);
}

/// Throws BadRequest for a value out of its option's range.
void require_ranges(const SolverOptions& options) {
  for_each_option([&](const auto& row) {
    const auto value = value_in(row, options);
    if (!value || is_in_range(row, *value)) return;
    throw BadRequest(out_of_range(row, *value));
  });
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

/// A curve that may leave its spline at any time needs a clock.
void require_clock_for(Beyond beyond, const RegionHeader& header) {
  if (beyond != Beyond::enter || is_live(stream_clock(header))) return;
  throw BadRequest("beyond 'enter' is for live streams: a recorded stream takes report or refuse");
}

}  // namespace

void require_options(const SolverOptions& options) {
  require_ranges(options);
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
  for_each_option([&](const auto& row) {
    // The header of a law's ring, of which this is a copy, already has the largest rate.
    if constexpr (!kIsOfLaw<decltype(row)>) {
      put_value(row, value_in(row, options).value_or(row.preset), header);
    }
  });
  if (!options.settle) header.settle = core::default_settle(method);
  if (!options.min_entry) header.min_entry = header.freeze_ahead;
  header.capacity = std::bit_ceil(header.capacity);
  put_limits(limits_for(options, header), header);
  require_clock_for(static_cast<Beyond>(header.beyond), header);
  header.rules = kRules;
}

std::optional<LiveOptions> live_options(const RegionHeader& header) noexcept {
  if (!is_live(stream_clock(header))) return std::nullopt;
  return LiveOptions{.settle_ahead = Time(header.freeze_ahead),
                     .history = Time(header.history),
                     .least_entry = Time(header.min_entry),
                     .follows_law = stream_clock(header) == StreamClock::law};
}

namespace {

/// The largest rate of the law that a stream follows; 1 if it follows none, or if an earlier
/// version has recorded it.
double rate_of_law(const RegionHeader& header) noexcept {
  return header.law_id != 0 && header.largest_rate > 0 ? header.largest_rate : 1;
}

}  // namespace

void put_law(const RegionHeader& law, RegionHeader& header) noexcept {
  header.law_id = law.stream_id;
  header.largest_rate = law.largest_rate;
}

core::WindowOptions window_options(const RegionHeader& header) {
  return {.interpolant = {.method = find_method(header.method),
                          .lambda = header.lambda,
                          .time_scale = header.time_scale},
          .settle = header.settle,
          .tail = static_cast<Tail>(header.tail),
          .start = start_condition(header),
          .stop_length = Time(header.stop_time),
          .limits = motion_limits(header),
          .max_rate = rate_of_law(header),
          .held_before_start = is_live(stream_clock(header)),
          .accepts_short_lag = header.force_lag != 0};
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

void require_same_options(const std::string& stream, const RegionHeader& existing,
                          const SolverOptions& options) {
  require_same(stream, "rules", std::optional(kRules), existing.rules, std::to_string(kRules),
               std::to_string(existing.rules));
  const Method* const method = find_method(existing.method);
  if (options.method != nullptr) {
    require_same<const Method*>(stream, "method", options.method, method,
                                std::string(options.method->name), std::string(method->name));
  }
  for_each_option([&](const auto& row) {
    auto wanted = value_in(row, options);
    if constexpr (kIsRowOf<&SolverOptions::capacity, decltype(row)>) {
      if (wanted) wanted = std::bit_ceil(*wanted);
    }
    if (is_set(row, options) && has_option(row, existing)) {
      const auto found = value_in(row, existing);
      require_same(stream, row.name, wanted, found, value_text(*wanted), value_text(found));
    }
  });
  require_same_limits(stream, existing, options);
}

}  // namespace splinecast::ipc
