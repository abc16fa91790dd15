#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/basics/number_text.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct NamedList {
  std::string_view name;
  const std::vector<double>* values;
};

std::array<NamedList, 3> magnitudes(const MotionLimits& limits) noexcept {
  return {{{"velocity limit", &limits.velocity},
           {"acceleration limit", &limits.acceleration},
           {"jerk limit", &limits.jerk}}};
}

std::array<NamedList, 5> lists(const MotionLimits& limits) noexcept {
  const auto [velocity, acceleration, jerk] = magnitudes(limits);
  return {{velocity,
           acceleration,
           jerk,
           {"lower bound", &limits.lower},
           {"upper bound", &limits.upper}}};
}

double bound_or(const std::vector<double>& bounds, std::size_t d, double none) noexcept {
  return d < bounds.size() ? bounds[d] : none;
}

bool all_are(const std::vector<double>& values, double none) noexcept {
  return std::ranges::all_of(values, [none](double value) { return value == none; });
}

[[noreturn]] void refuse_bounds(double lower, double upper) {
  throw std::invalid_argument("the lower bound must be below the upper bound, not " +
                              core::number_text(lower) + " and " + core::number_text(upper));
}

void require_size(const NamedList& list, std::size_t dimensions) {
  if (list.values->empty() || list.values->size() == dimensions) return;
  throw std::invalid_argument(std::to_string(list.values->size()) + ' ' + std::string(list.name) +
                              "s for " + std::to_string(dimensions) + " dimensions");
}

/// Throws unless the second to fourth dimension of a quaternion have no limit or that of the first.
void require_first_alone(const MotionLimits& limits, std::size_t first) {
  for (const auto& [name, values] : magnitudes(limits)) {
    if (values->empty()) continue;
    for (std::size_t d = first + 1; d < first + kQuaternionSize; ++d) {
      const double value = (*values)[d];
      if (value == 0 || value == (*values)[first]) continue;
      throw std::invalid_argument(std::string(name) + ' ' + core::number_text(value) +
                                  " of dimension " + std::to_string(d) +
                                  ": a quaternion has the limit of its first dimension, " +
                                  std::to_string(first));
    }
  }
}

}  // namespace

bool MotionLimits::empty() const noexcept {
  return all_are(velocity, 0) && all_are(acceleration, 0) && all_are(jerk, 0) &&
         all_are(lower, -kInfinity) && all_are(upper, kInfinity);
}

void require_limits(const MotionLimits& limits) {
  for (const auto& [name, values] : magnitudes(limits)) {
    for (const double value : *values) {
      if (is_usable(value) && value >= 0) continue;
      throw std::invalid_argument(std::string(name) + " must be positive, or 0 for none, not " +
                                  core::number_text(value));
    }
  }
  const bool has_pairs = limits.lower.size() == limits.upper.size();
  for (std::size_t d = 0; d < std::max(limits.lower.size(), limits.upper.size()); ++d) {
    const double lower = bound_or(limits.lower, d, -kInfinity);
    const double upper = bound_or(limits.upper, d, kInfinity);
    const bool are_numbers =
        (is_usable(lower) || lower == -kInfinity) && (is_usable(upper) || upper == kInfinity);
    if (!are_numbers || (has_pairs && lower >= upper)) refuse_bounds(lower, upper);
  }
}

void require_limits(const MotionLimits& limits, std::size_t dimensions) {
  for (const NamedList& list : lists(limits)) require_size(list, dimensions);
  require_limits(limits);
}

void require_limits(const MotionLimits& limits, std::span<const Dimension> dimensions) {
  require_limits(limits, dimensions.size());
  for (std::size_t d = 0; d < dimensions.size(); ++d) {
    if (dimensions[d].kind == DimensionKind::linear) continue;
    if (bound_or(limits.lower, d, -kInfinity) == -kInfinity &&
        bound_or(limits.upper, d, kInfinity) == kInfinity) {
      continue;
    }
    throw std::invalid_argument("dimension " + std::to_string(d) + " is of kind " +
                                to_string(dimensions[d]) + ", which has no bounds");
  }
  const DimensionKinds kinds(dimensions);
  for (const QuaternionDimensions& quaternion : kinds.quaternions()) {
    require_first_alone(limits, quaternion.first);
  }
}

MotionLimits spread(const MotionLimits& limits, std::size_t dimensions) {
  MotionLimits out = limits;
  for (std::vector<double>* const values :
       {&out.velocity, &out.acceleration, &out.jerk, &out.lower, &out.upper}) {
    if (values->size() == 1) values->resize(dimensions, values->front());
  }
  for (const NamedList& list : lists(out)) require_size(list, dimensions);
  return out;
}

std::string_view to_string(LimitKind kind) noexcept {
  constexpr std::array<std::string_view, kLimitKinds> kNames{"velocity", "acceleration", "jerk",
                                                             "position"};
  return kNames[static_cast<std::size_t>(kind)];
}

namespace {

constexpr std::array<std::string_view, kBeyonds> kBeyondNames{"report", "refuse", "enter"};

}  // namespace

std::string_view to_string(Beyond beyond) noexcept {
  return kBeyondNames[static_cast<std::size_t>(beyond)];
}

std::optional<Beyond> parse_beyond(std::string_view text) noexcept {
  for (std::uint8_t i = 0; i < kBeyonds; ++i) {
    if (kBeyondNames[i] == text) return static_cast<Beyond>(i);
  }
  return std::nullopt;
}

}  // namespace splinecast
