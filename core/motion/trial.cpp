#include "core/motion/trial.hpp"

#include <algorithm>

#include "core/limits/limit_of.hpp"

namespace splinecast::core {
namespace {

TimedExcess timed(const Excess& excess, const Segment& segment) noexcept {
  return {excess, std::min(segment.left + from_seconds(excess.u), segment.right)};
}

}  // namespace

std::optional<TimedExcess> excess_of_stop(const SlidingWindow& window, const Segment& stop,
                                          StopBounds counted, std::span<double> scratch) noexcept {
  constexpr double kSlack = 1 + 2e-6;
  const MotionLimits& limits = window.limits_at_largest_rate();
  const SegmentPart part = part_of(stop);
  std::optional<TimedExcess> worst;
  double ratio = kSlack;
  const auto take = [&](const Excess& found) {
    if (!(found.ratio > ratio)) return;
    ratio = found.ratio;
    worst = timed(found, stop);
  };
  for (const Excess& found : worst_excesses(limits, &window.kinds(), part)) {
    if (found.kind == LimitKind::acceleration || found.kind == LimitKind::jerk) take(found);
  }
  const double end_of_stop = to_seconds(stop.right - stop.left);
  evaluate_derivative(stop.order, stop.coefficients, end_of_stop, 0, scratch);
  for (std::size_t d = 0; d < part.dimensions; ++d) {
    const double begin = stop.coefficients[d];
    const double end = scratch[d];
    const bool rises = end > begin;
    const auto& bounds = rises ? limits.upper : limits.lower;
    if (counted == StopBounds::limited && limit_of(limits.acceleration, d) == 0) continue;
    if (bounds.empty() || (rises ? end <= bounds[d] : end >= bounds[d] || end == begin)) continue;
    take({.ratio = ratio_of(limits, LimitKind::position, d, end, bounds[d]),
          .kind = LimitKind::position,
          .dimension = d,
          .value = end,
          .limit = bounds[d],
          .u = end_of_stop});
  }
  return worst;
}

Trial::Trial(std::size_t dimensions, const WindowOptions& options)
    : window_(dimensions, options),
      knots_(window_.knots_to_restore()),
      segment_(dimensions),
      unchanged_(dimensions),
      values_(dimensions) {}

std::optional<TimedExcess> Trial::worst_excess(std::size_t first,
                                               const SlidingWindow* unchanged) noexcept {
  const MotionLimits& limits = window_.options().limits;
  const DimensionKinds& kinds = window_.kinds();
  std::optional<TimedExcess> worst;
  for (std::size_t i = std::max(first, window_.oldest_segment()); i + 1 < window_.knots(); ++i) {
    window_.segment(i, segment_);
    if (keeps_within(limits, &kinds, segment_)) continue;
    if (unchanged != nullptr && i + 1 < unchanged->knots()) {
      unchanged->segment(i, unchanged_);
      if (!keeps_within(limits, &kinds, unchanged_)) continue;
    }
    const TimedExcess found = timed(core::worst_excess(limits, &kinds, segment_), segment_);
    if (!worst || found.excess.ratio > worst->excess.ratio) worst = found;
  }
  return worst;
}

bool Trial::exceeds_no_more(const MotionLimits& limits, std::size_t first,
                            const SlidingWindow& unchanged) noexcept {
  const DimensionKinds& kinds = window_.kinds();
  for (std::size_t i = std::max(first, window_.oldest_segment()); i + 1 < window_.knots(); ++i) {
    window_.segment(i, segment_);
    if (keeps_within(limits, &kinds, segment_)) continue;
    unchanged.segment(i, unchanged_);
    if (!core::exceeds_no_more(limits, &kinds, part_of(segment_), part_of(unchanged_))) {
      return false;
    }
  }
  return true;
}

std::optional<TimedExcess> Trial::excess_of_newest_stop() noexcept {
  window_.segment(window_.knots() - 1, segment_);
  return core::excess_of_stop(window_, segment_, StopBounds::limited, values_);
}

}  // namespace splinecast::core
