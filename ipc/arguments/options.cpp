#include "ipc/arguments/options.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "core/basics/number_text.hpp"
#include "ipc/arguments/arrays.hpp"
#include "ipc/arguments/enums.hpp"
#include "ipc/arguments/structs.hpp"
#include "splinecast/method.hpp"

namespace splinecast::ipc {
namespace {

constexpr std::int64_t kNotSet = -1;

void require_count(std::size_t count, std::size_t dimensions, std::string_view name) {
  if (count == dimensions) return;
  refuse(name, "has " + std::to_string(count) + " elements, not " + std::to_string(dimensions));
}

std::vector<std::string> texts(const char* const* given, std::size_t count, std::size_t dimensions,
                               const char* name) {
  const auto found = require_objects(given, count, name);
  if (count > 0) require_count(count, dimensions, name);
  std::vector<std::string> all;
  for (const char* text : found) all.emplace_back(require_text(text, name));
  return all;
}

std::vector<Dimension> kinds(const splinecast_producer_options& given) {
  const auto found = require_objects(given.kinds, given.kind_count, "options->kinds");
  if (given.kind_count > 0) require_count(given.kind_count, given.dimensions, "options->kinds");
  std::vector<Dimension> all;
  for (const splinecast_dimension& one : found) {
    const int kind = require_choice(one.kind, kDimensionKinds, "options->kinds->kind");
    all.push_back({.kind = static_cast<DimensionKind>(kind), .period = one.period});
  }
  return all;
}

/// Number of a user or a group, which is not (uid_t)−1.
std::optional<std::uint32_t> identity(std::int64_t number, const char* name) {
  if (number == kNotSet) return std::nullopt;
  if (number < 0 || number >= std::numeric_limits<std::uint32_t>::max()) {
    refuse(name, "is " + std::to_string(number) + ", not -1 or a number of a user or group");
  }
  return static_cast<std::uint32_t>(number);
}

const Method* method(const char* name) {
  if (name == nullptr) return nullptr;
  const std::string text(require_text(name, "options->method"));
  const Method* found = find_method(text);
  if (found == nullptr) {
    refuse("options->method", "'" + text + "' is not one of " + method_names(false));
  }
  return found;
}

/// A number that is set, or nothing for −1.
std::optional<double> number(double value, const char* name) {
  if (value == static_cast<double>(kNotSet)) return std::nullopt;
  if (!(value >= 0)) refuse(name, "is " + core::number_text(value));
  return value;
}

std::optional<std::int64_t> whole(std::int64_t value, const char* name) {
  if (value == kNotSet) return std::nullopt;
  if (value < 0) refuse(name, "is " + std::to_string(value));
  return value;
}

std::optional<Time> time(std::int64_t value, const char* name) {
  const auto set = whole(value, name);
  return set ? std::optional(Time(*set)) : std::nullopt;
}

std::optional<std::size_t> size(std::int64_t value, const char* name) {
  const auto set = whole(value, name);
  return set ? std::optional(static_cast<std::size_t>(*set)) : std::nullopt;
}

template <typename Enum>
std::optional<Enum> choice(int value, int count, const char* name) {
  if (value == kNotSet) return std::nullopt;
  return static_cast<Enum>(require_choice(value, count, name));
}

/// A list of limits: one value for all dimensions, or one for each.
std::vector<double> list(const splinecast_vector& given, const char* name) {
  const Values values(given.data, given.count, given.stride, name);
  if (values.given() && (values.size() < kMinDimensions || values.size() > kMaxDimensions)) {
    refuse(name, "has " + std::to_string(values.size()) + " values, not 1 to 64");
  }
  std::vector<double> copy;
  for (std::size_t i = 0; i < values.size(); ++i) copy.push_back(values[i]);
  return copy;
}

std::optional<MotionLimits> limits(const splinecast_limits* given) {
  if (given == nullptr) return std::nullopt;
  const splinecast_limits all = read_struct(given, SPLINECAST_LIMITS_INIT, "options->limits");
  return MotionLimits{.velocity = list(all.velocity, "options->limits->velocity"),
                      .acceleration = list(all.acceleration, "options->limits->acceleration"),
                      .jerk = list(all.jerk, "options->limits->jerk"),
                      .lower = list(all.lower, "options->limits->lower"),
                      .upper = list(all.upper, "options->limits->upper")};
}

std::vector<NamedLimits> named_limits(const splinecast_solver_options& given) {
  constexpr std::size_t kMost = 4096;
  const char* const name = "options->named_limits";
  const auto found = require_objects(given.named_limits, given.named_limit_count, name);
  if (found.size() > kMost) refuse(name, "has " + std::to_string(found.size()) + " elements");
  std::vector<NamedLimits> all;
  for (const splinecast_named_limits& one : found) {
    all.push_back({.name = std::string(require_text(one.name, "options->named_limits->name")),
                   .velocity = one.velocity,
                   .acceleration = one.acceleration,
                   .jerk = one.jerk,
                   .lower = one.lower,
                   .upper = one.upper});
  }
  return all;
}

}  // namespace

RegionAccess access_of(std::uint32_t mode, std::int64_t group) {
  constexpr std::uint32_t kPermissions = 0777;
  if (mode > kPermissions) {
    refuse("options->mode", "is " + std::to_string(mode) + " (decimal), more than 0777");
  }
  return {.mode = mode, .group = identity(group, "options->group")};
}

Trust trust_of(std::int64_t owner, const char* name) { return {.owner = identity(owner, name)}; }

Condition condition(const splinecast_condition& given, std::size_t dimensions, const char* name) {
  const int kind = require_choice(given.kind, kConditionKinds, name);
  Condition found{.kind = static_cast<ConditionKind>(kind), .value = {}};
  const Values values = optional_vector(given.value, dimensions, name);
  for (std::size_t i = 0; i < values.size(); ++i) found.value.push_back(values[i]);
  return found;
}

ProducerOptions producer_options(const splinecast_producer_options* given) {
  const auto all = read_optional(given, SPLINECAST_PRODUCER_OPTIONS_INIT, "options",
                                 offsetof(splinecast_producer_options, law));
  if (all.dimensions < kMinDimensions || all.dimensions > kMaxDimensions) {
    refuse("options->dimensions", "is " + std::to_string(all.dimensions) + ", not 1 to 64");
  }
  const int clock = require_choice(all.clock, kClocks, "options->clock");
  return {
      .dimensions = all.dimensions,
      .names = texts(all.names, all.name_count, all.dimensions, "options->names"),
      .units = texts(all.units, all.unit_count, all.dimensions, "options->units"),
      .kinds = kinds(all),
      .clock = static_cast<StreamClock>(clock),
      .law = all.law == nullptr ? "" : std::string(require_text(all.law, "options->law")),
      .start = condition(all.start, all.dimensions, "options->start"),
      .limits = {.min_interval = Time(all.min_interval), .max_interval = Time(all.max_interval)},
      .horizon = Time(all.horizon),
      .start_tolerance = all.start_tolerance,
      .capacity = all.capacity,
      .access = access_of(all.mode, all.group),
      .trust = trust_of(all.owner, "options->owner")};
}

SolverOptions solver_options(const splinecast_solver_options* given) {
  const auto all = read_optional(given, SPLINECAST_SOLVER_OPTIONS_INIT, "options",
                                 offsetof(splinecast_solver_options, largest_rate));
  if (all.reserved != 0) refuse("options->reserved", "is not 0");
  return {.method = method(all.method),
          .lambda = number(all.lambda, "options->lambda"),
          .time_scale = number(all.time_scale, "options->time_scale"),
          .settle = size(all.settle, "options->settle"),
          .tail = choice<Tail>(all.tail, kTails, "options->tail"),
          .force_lag = require_flag(all.force_lag, "options->force_lag"),
          .stop_time = time(all.stop_time, "options->stop_time"),
          .limits = limits(all.limits),
          .named_limits = named_limits(all),
          .beyond = choice<Beyond>(all.beyond, kBeyonds, "options->beyond"),
          .freeze_ahead = time(all.freeze_ahead, "options->freeze_ahead"),
          .history = time(all.history, "options->history"),
          .min_entry = time(all.min_entry, "options->min_entry"),
          .largest_rate = number(all.largest_rate, "options->largest_rate"),
          .capacity = size(all.capacity, "options->capacity"),
          .wake = require_flag(all.wake, "options->wake"),
          .access = access_of(all.mode, all.group),
          .trust = trust_of(all.owner, "options->owner")};
}

FitOptions fit_options(const splinecast_fit_options* given, std::size_t dimensions) {
  const auto all = read_optional(given, SPLINECAST_FIT_OPTIONS_INIT, "options");
  const Method* named = method(all.method);
  return {.interpolant = {.method = named != nullptr ? named : &c2(),
                          .lambda = all.lambda,
                          .time_scale = all.time_scale},
          .start = condition(all.start, dimensions, "options->start"),
          .end = condition(all.end, dimensions, "options->end")};
}

}  // namespace splinecast::ipc
