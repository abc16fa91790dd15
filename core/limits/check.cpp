#include "core/limits/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/limits/for_all.hpp"
#include "core/limits/rotation_bounds.hpp"

namespace splinecast::core {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Number of bisections that locate a violation: to 2⁻³⁰ < 10⁻⁹ of the range.
constexpr int kHalvings = 30;

constexpr std::array kMagnitudes{LimitKind::velocity, LimitKind::acceleration, LimitKind::jerk};

/// The derivative to which a limit applies: 0 is the position.
constexpr int derivative_of(LimitKind kind) noexcept {
  return (static_cast<int>(kind) + 1) % static_cast<int>(kLimitKinds);
}

double value_or(std::span<const double> values, std::size_t d, double none) noexcept {
  return d < values.size() ? values[d] : none;
}

/// The limits and the part of a curve to compare.
struct Comparison {
  const MotionLimits& limits;
  const SegmentPart& part;
  const Allowance& allowance;

  /// The limit of a dimension, or its allowance if that is larger; 0: none.
  [[nodiscard]] double limit(LimitKind kind, std::size_t d) const noexcept {
    const bool is_velocity = kind == LimitKind::velocity;
    if (kind == LimitKind::jerk) return value_or(limits.jerk, d, 0);
    const double limit = value_or(is_velocity ? limits.velocity : limits.acceleration, d, 0);
    if (limit == 0) return 0;
    return std::max(limit,
                    value_or(is_velocity ? allowance.velocity : allowance.acceleration, d, 0));
  }

  [[nodiscard]] double rounding(LimitKind kind, std::size_t d) const noexcept {
    return kExtremeRounding * size_of_terms(part, d, derivative_of(kind));
  }
};

/// The excess of one limit, and whether the limit is respected.
struct Finding {
  Excess excess;
  bool is_kept = false;
};

Finding magnitude_finding(const Comparison& comparison, LimitKind kind, std::size_t d, double limit,
                          const SegmentRange& range) noexcept {
  const Extreme largest = range.largest();
  const double size = std::abs(largest.value);
  const double ratio = std::isnan(size) ? kInfinity : size / limit;
  const bool is_kept = size <= limit || size <= limit + comparison.rounding(kind, d);
  return {{ratio, kind, d, largest.value, limit, largest.u}, is_kept};
}

/// The ratio of a value to its bounds, at least one of which is finite.
double ratio_to_bounds(double value, double lower, double upper) noexcept {
  if (std::isnan(value)) return kInfinity;
  if (lower > -kInfinity && upper < kInfinity) {
    return std::abs(value - (lower + upper) / 2) / ((upper - lower) / 2);
  }
  const double bound = upper < kInfinity ? upper : lower;
  const double outside = upper < kInfinity ? value - upper : lower - value;
  return std::max(0.0, 1 + outside / std::max(1.0, std::abs(bound)));
}

Finding position_finding(const Comparison& comparison, std::size_t d, double lower, double upper,
                         const SegmentRange& range) noexcept {
  const auto excess_of = [&](const Extreme& extreme) {
    const bool is_nearer_to_lower =
        upper == kInfinity || (lower > -kInfinity && extreme.value < (lower + upper) / 2);
    return Excess{ratio_to_bounds(extreme.value, lower, upper),
                  LimitKind::position,
                  d,
                  extreme.value,
                  is_nearer_to_lower ? lower : upper,
                  extreme.u};
  };
  const Excess low = excess_of(range.least);
  const Excess high = excess_of(range.greatest);
  const bool is_low = upper == kInfinity || (lower > -kInfinity && low.ratio > high.ratio);
  bool is_kept = range.least.value >= lower && range.greatest.value <= upper;
  if (!is_kept) {
    const double rounding = comparison.rounding(LimitKind::position, d);
    is_kept = range.least.value >= lower - rounding && range.greatest.value <= upper + rounding;
  }
  return {is_low ? low : high, is_kept};
}

/// Calls take(finding) for each limit of a dimension. Stops and returns false if a call returns
/// false.
bool take_dimension(const Comparison& comparison, std::size_t d, auto& take) noexcept {
  constexpr std::array kSets{Derivatives::velocity, Derivatives::acceleration, Derivatives::jerk};
  std::array<double, kMagnitudes.size()> limits{};
  Derivatives which = Derivatives::none;
  for (std::size_t i = 0; i < kMagnitudes.size(); ++i) {
    limits[i] = comparison.limit(kMagnitudes[i], d);
    if (limits[i] > 0) which = which | kSets[i];
  }
  const double lower = value_or(comparison.limits.lower, d, -kInfinity);
  const double upper = value_or(comparison.limits.upper, d, kInfinity);
  const bool has_bounds = lower > -kInfinity || upper < kInfinity;
  if (has_bounds) which = which | Derivatives::position;
  if (which == Derivatives::none) return true;
  std::array<SegmentRange, 4> ranges;
  write_ranges(comparison.part, d, which, ranges);
  for (std::size_t i = 0; i < kMagnitudes.size(); ++i) {
    if (limits[i] == 0) continue;
    if (!take(magnitude_finding(comparison, kMagnitudes[i], d, limits[i], ranges[i + 1]))) {
      return false;
    }
  }
  return !has_bounds || take(position_finding(comparison, d, lower, upper, ranges[0]));
}

std::span<const QuaternionDimensions> quaternions_of(const DimensionKinds* kinds) noexcept {
  return kinds == nullptr ? std::span<const QuaternionDimensions>() : kinds->quaternions();
}

bool rotation_keeps(const Comparison& comparison, const QuaternionDimensions& quaternion) noexcept {
  const auto limit = [&](LimitKind kind) { return comparison.limit(kind, quaternion.first); };
  const bool has_any =
      std::ranges::any_of(kMagnitudes, [&](LimitKind kind) { return limit(kind) > 0; });
  if (!has_any) return true;
  const RotationBounds bounds(comparison.part, quaternion);
  return std::ranges::all_of(kMagnitudes, [&](LimitKind kind) {
    return limit(kind) == 0 || bounds.keeps(derivative_of(kind), limit(kind));
  });
}

void take_rotation_excesses(const Comparison& comparison, const QuaternionDimensions& quaternion,
                            const auto& take) noexcept {
  const RotationBounds bounds(comparison.part, quaternion);
  for (const LimitKind kind : kMagnitudes) {
    const double limit = comparison.limit(kind, quaternion.first);
    if (limit == 0) continue;
    const Extreme most = bounds.bound(derivative_of(kind));
    take(Excess{most.value / limit, kind, quaternion.first, most.value, limit, most.u});
  }
}

}  // namespace

double ratio_of(const MotionLimits& limits, LimitKind kind, std::size_t dimension, double value,
                double limit) noexcept {
  if (kind != LimitKind::position) return std::isnan(value) ? kInfinity : std::abs(value) / limit;
  return ratio_to_bounds(value, value_or(limits.lower, dimension, -kInfinity),
                         value_or(limits.upper, dimension, kInfinity));
}

bool keeps_within(const MotionLimits& limits, const DimensionKinds* kinds, const SegmentPart& part,
                  const Allowance& allowance) noexcept {
  const Comparison comparison{limits, part, allowance};
  auto is_kept = [](const Finding& finding) { return finding.is_kept; };
  return for_all(
      quaternions_of(kinds), part.dimensions,
      [&](std::size_t d) { return take_dimension(comparison, d, is_kept); },
      [&](const QuaternionDimensions& quaternion) {
        return rotation_keeps(comparison, quaternion);
      });
}

bool keeps_within(const MotionLimits& limits, const DimensionKinds* kinds, const Segment& segment,
                  const Allowance& allowance) noexcept {
  return keeps_within(limits, kinds, part_of(segment), allowance);
}

namespace {

WorstExcesses no_excesses() noexcept {
  WorstExcesses worst{};
  for (std::size_t i = 0; i < kLimitKinds; ++i) worst[i].kind = static_cast<LimitKind>(i);
  return worst;
}

void take_larger(const Excess& excess, WorstExcesses& worst) noexcept {
  Excess& so_far = worst[static_cast<std::size_t>(excess.kind)];
  if (excess.ratio > so_far.ratio) so_far = excess;
}

void take_worst(const Comparison& comparison, std::size_t d, WorstExcesses& worst) noexcept {
  auto take = [&](const Finding& finding) {
    take_larger(finding.excess, worst);
    return true;
  };
  (void)take_dimension(comparison, d, take);
}

void take_worst(const Comparison& comparison, const QuaternionDimensions& quaternion,
                WorstExcesses& worst) noexcept {
  take_rotation_excesses(comparison, quaternion,
                         [&](const Excess& excess) { take_larger(excess, worst); });
}

}  // namespace

WorstExcesses worst_excesses(const MotionLimits& limits, const DimensionKinds* kinds,
                             const SegmentPart& part, const Allowance& allowance) noexcept {
  const Comparison comparison{limits, part, allowance};
  WorstExcesses worst = no_excesses();
  const auto take = [&](const auto& dimension) {
    take_worst(comparison, dimension, worst);
    return true;
  };
  (void)for_all(quaternions_of(kinds), part.dimensions, take, take);
  return worst;
}

bool exceeds_no_more(const MotionLimits& limits, const DimensionKinds* kinds,
                     const SegmentPart& part, const SegmentPart& other) noexcept {
  if (keeps_within(limits, kinds, part)) return true;
  const Allowance none;
  const Comparison own{limits, part, none};
  const Comparison others{limits, other, none};
  const auto is_as_good = [&](const auto& dimension) {
    constexpr double kSlack = 1 + 1e-9;
    WorstExcesses mine = no_excesses();
    WorstExcesses its = no_excesses();
    take_worst(own, dimension, mine);
    take_worst(others, dimension, its);
    for (std::size_t i = 0; i < kLimitKinds; ++i) {
      if (!(mine[i].ratio <= std::max(its[i].ratio, 1.0) * kSlack)) return false;
    }
    return true;
  };
  return for_all(quaternions_of(kinds), part.dimensions, is_as_good, is_as_good);
}

bool keeps_length(const DimensionKinds& kinds, const Segment& segment) noexcept {
  constexpr int kLooks = 16;
  constexpr double kLeast = 0.7;
  const double duration = to_seconds(segment.right - segment.left);
  std::array<double, kMaxDimensions> values;  // NOLINT(*-member-init)
  const auto position = std::span(values).first(segment.acceleration_step.size());
  for (int i = 1; i < kLooks && !kinds.quaternions().empty(); ++i) {
    evaluate_derivative(segment.order, segment.coefficients, duration * i / kLooks, 0, position);
    for (const QuaternionDimensions& q : kinds.quaternions()) {
      double squares = 0;
      for (const double x : position.subspan(q.first, kQuaternionSize)) squares += x * x;
      if (squares < kLeast * kLeast) return false;
    }
  }
  return true;
}

Excess worst_excess(const MotionLimits& limits, const DimensionKinds* kinds,
                    const SegmentPart& part, const Allowance& allowance) noexcept {
  return std::ranges::max(worst_excesses(limits, kinds, part, allowance), {}, &Excess::ratio);
}

Excess worst_excess(const MotionLimits& limits, const DimensionKinds* kinds, const Segment& segment,
                    const Allowance& allowance) noexcept {
  return worst_excess(limits, kinds, part_of(segment), allowance);
}

Excess worst_excess(const MotionLimits& limits, const DimensionKinds* kinds,
                    const State& state) noexcept {
  // The cubic that has this state at its left end.
  std::array<double, kCubicOrder * kMaxDimensions> coefficients;  // NOLINT(*-member-init)
  const std::size_t dimensions = state.dimensions();
  for (std::size_t d = 0; d < dimensions; ++d) {
    coefficients[d] = state.position()[d];
    coefficients[dimensions + d] = state.velocity()[d];
    coefficients[2 * dimensions + d] = state.acceleration()[d] / 2;
    coefficients[3 * dimensions + d] = state.jerk()[d] / 6;
  }
  return worst_excess(limits, kinds,
                      SegmentPart{.order = kCubicOrder,
                                  .coefficients = std::span(coefficients).first(4 * dimensions),
                                  .dimensions = dimensions});
}

std::optional<Excess> first_violation(const MotionLimits& limits, const DimensionKinds* kinds,
                                      const SegmentPart& part,
                                      const Allowance& allowance) noexcept {
  if (keeps_within(limits, kinds, part, allowance)) return std::nullopt;
  SegmentPart start = part;
  start.to = part.from;
  if (!keeps_within(limits, kinds, start, allowance)) {
    return worst_excess(limits, kinds, start, allowance);
  }
  // No limit is exceeded up to `kept`; one is exceeded up to `start.to`.
  double kept = part.from;
  start.to = part.to;
  for (int i = 0; i < kHalvings; ++i) {
    SegmentPart half = start;
    half.to = kept + (start.to - kept) / 2;
    if (keeps_within(limits, kinds, half, allowance)) {
      kept = half.to;
    } else {
      start = half;
    }
  }
  start.from = kept;
  return worst_excess(limits, kinds, start, allowance);
}

std::optional<Excess> first_violation(const MotionLimits& limits, const DimensionKinds* kinds,
                                      const Segment& segment, const Allowance& allowance) noexcept {
  return first_violation(limits, kinds, part_of(segment), allowance);
}

}  // namespace splinecast::core
