#include "ipc/arguments/options.hpp"

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "ipc/arguments/arrays.hpp"
#include "ipc/arguments/enums.hpp"
#include "ipc/arguments/structs.hpp"
#include "ipc/layout/options.hpp"
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

/// The value of an option that is set; nothing for −1. A flag is 0 or 1.
template <typename Row>
std::optional<typename Row::Value> set_value(const Row& row, const splinecast_solver_options& all) {
  using Value = typename Row::Value;
  const auto given = all.*Row::kInC;
  const std::string name = "options->" + std::string(row.key);
  if constexpr (std::is_same_v<Value, bool>) {
    return require_flag(given, name.c_str());
  } else {
    if (given == static_cast<decltype(given)>(kNotSet)) return std::nullopt;
    if constexpr (std::is_enum_v<Value>) {
      return static_cast<Value>(
          require_choice(given, static_cast<int>(row.range.most) + 1, name.c_str()));
    } else {
      if (!(given >= 0)) refuse(name, "is " + value_text(given));
      return static_cast<Value>(given);
    }
  }
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
  ProducerOptions options{
      .dimensions = all.dimensions,
      .names = texts(all.names, all.name_count, all.dimensions, "options->names"),
      .units = texts(all.units, all.unit_count, all.dimensions, "options->units"),
      .kinds = kinds(all),
      .clock = static_cast<StreamClock>(clock),
      .law = all.law == nullptr ? "" : std::string(require_text(all.law, "options->law")),
      .start = condition(all.start, all.dimensions, "options->start"),
      .access = access_of(all.mode, all.group),
      .trust = trust_of(all.owner, "options->owner")};
  for_each_stream_option([&](const auto& row) {
    using Row = std::remove_cvref_t<decltype(row)>;
    Row::kOption(options) = static_cast<typename Row::Value>(all.*Row::kInC);
  });
  return options;
}

SolverOptions solver_options(const splinecast_solver_options* given) {
  const auto all = read_optional(given, SPLINECAST_SOLVER_OPTIONS_INIT, "options",
                                 offsetof(splinecast_solver_options, largest_rate));
  if (all.reserved != 0) refuse("options->reserved", "is not 0");
  SolverOptions options{.method = method(all.method),
                        .limits = limits(all.limits),
                        .named_limits = named_limits(all),
                        .wake = require_flag(all.wake, "options->wake"),
                        .access = access_of(all.mode, all.group),
                        .trust = trust_of(all.owner, "options->owner")};
  for_each_option([&](const auto& row) {
    using Row = std::remove_cvref_t<decltype(row)>;
    if (const auto value = set_value(row, all)) options.*Row::kOption = *value;
  });
  return options;
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
