#include "core/limits/named.hpp"

#include <algorithm>
#include <stdexcept>
#include <string_view>

namespace splinecast::core {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A name without the unit in brackets after it.
std::string_view without_unit(std::string_view name) {
  if (name.empty() || (name.back() != ']' && name.back() != ')')) return name;
  const std::size_t open = name.rfind(name.back() == ']' ? '[' : '(');
  if (open == std::string_view::npos) return name;
  const std::size_t end = name.find_last_not_of(" \t", open == 0 ? 0 : open - 1);
  return end == std::string_view::npos ? name : name.substr(0, end + 1);
}

const NamedLimits* joint_of(std::span<const NamedLimits> joints, const std::string& dimension) {
  const auto is_it = [&](const NamedLimits& joint) { return is_name_of(joint.name, dimension); };
  const auto found = std::ranges::find_if(joints, is_it);
  if (found == joints.end()) return nullptr;
  if (std::find_if(found + 1, joints.end(), is_it) != joints.end()) {
    throw std::invalid_argument("dimension '" + dimension + "' has limits under two names");
  }
  return &*found;
}

/// Clears a list if all its values mean "none".
void drop_if_none(std::vector<double>& values, double none) {
  if (std::ranges::all_of(values, [none](double value) { return value == none; })) values.clear();
}

bool has_value(const std::vector<double>& values, std::size_t d, double none) {
  return d < values.size() && values[d] != none;
}

}  // namespace

bool is_name_of(const std::string& joint, const std::string& dimension) {
  return joint == dimension || joint == without_unit(dimension);
}

MotionLimits matched(std::span<const NamedLimits> joints, std::span<const std::string> dimensions) {
  MotionLimits limits;
  const NamedLimits none;
  for (const std::string& dimension : dimensions) {
    const NamedLimits* const joint = joint_of(joints, dimension);
    const NamedLimits& of = joint == nullptr ? none : *joint;
    limits.velocity.push_back(of.velocity);
    limits.acceleration.push_back(of.acceleration);
    limits.jerk.push_back(of.jerk);
    limits.lower.push_back(of.lower);
    limits.upper.push_back(of.upper);
  }
  drop_if_none(limits.velocity, 0);
  drop_if_none(limits.acceleration, 0);
  drop_if_none(limits.jerk, 0);
  drop_if_none(limits.lower, -kInfinity);
  drop_if_none(limits.upper, kInfinity);
  return limits;
}

std::vector<std::string> unmatched(std::span<const NamedLimits> joints,
                                   std::span<const std::string> dimensions) {
  std::vector<std::string> names;
  for (const NamedLimits& joint : joints) {
    const auto is_it = [&](const std::string& name) { return is_name_of(joint.name, name); };
    if (std::ranges::none_of(dimensions, is_it)) names.push_back(joint.name);
  }
  return names;
}

std::vector<std::size_t> without_limits(const MotionLimits& limits,
                                        std::span<const Dimension> dimensions) {
  std::vector<std::size_t> bare;
  const DimensionKinds kinds(dimensions);
  const auto is_further = [&](std::size_t d) {
    return std::ranges::any_of(kinds.quaternions(), [d](const QuaternionDimensions& quaternion) {
      return d > quaternion.first && d < quaternion.first + kQuaternionSize;
    });
  };
  for (std::size_t d = 0; d < dimensions.size(); ++d) {
    const bool has_any = has_value(limits.velocity, d, 0) || has_value(limits.acceleration, d, 0) ||
                         has_value(limits.jerk, d, 0) || has_value(limits.lower, d, -kInfinity) ||
                         has_value(limits.upper, d, kInfinity);
    if (!has_any && !is_further(d)) bare.push_back(d);
  }
  return bare;
}

MotionLimits overridden(const MotionLimits& base, const MotionLimits& by) {
  MotionLimits limits = base;
  if (!by.velocity.empty()) limits.velocity = by.velocity;
  if (!by.acceleration.empty()) limits.acceleration = by.acceleration;
  if (!by.jerk.empty()) limits.jerk = by.jerk;
  if (!by.lower.empty() || !by.upper.empty()) {
    limits.lower = by.lower;
    limits.upper = by.upper;
  }
  return limits;
}

}  // namespace splinecast::core
