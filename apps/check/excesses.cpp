#include "apps/check/excesses.hpp"

#include <algorithm>
#include <cmath>

namespace splinecast::apps {
namespace {

TimedExcess timed(const Excess& excess, Time left) {
  return {excess, left + Time(std::llround(excess.u * 1e9))};
}

/// The speed factor that reduces a ratio of this kind to 1.
double slowing_for(const Excess& excess) {
  constexpr double kRounding = 1 - 1e-12;
  const double share = kRounding / excess.ratio;
  switch (excess.kind) {
    case LimitKind::velocity:
      return share;
    case LimitKind::acceleration:
      return std::sqrt(share);
    case LimitKind::jerk:
      return std::cbrt(share);
    case LimitKind::position:
      break;
  }
  return 1;
}

void take_segment(const core::SegmentPart& part, Time left, const MotionLimits& limits,
                  const DimensionKinds& kinds, CurveCheck& check) {
  const core::WorstExcesses worst = core::worst_excesses(limits, &kinds, part);
  for (std::size_t kind = 0; kind < worst.size(); ++kind) {
    std::optional<TimedExcess>& so_far = check.worst[kind];
    if (worst[kind].ratio > (so_far ? so_far->excess.ratio : -1)) {
      so_far = timed(worst[kind], left);
    }
  }
  const auto violation = core::first_violation(limits, &kinds, part);
  if (!violation) return;
  ++check.segments_beyond;
  if (!check.first_violation) check.first_violation = timed(*violation, left);
  for (const Excess& excess : worst) {
    if (excess.ratio <= 1) continue;
    check.slowing = std::min(check.slowing, slowing_for(excess));
    if (excess.kind == LimitKind::position) check.keeps_bounds = false;
  }
}

}  // namespace

CurveCheck check_curve(std::span<const PiecewisePolynomial> parts, const MotionLimits& limits,
                       const DimensionKinds& kinds) {
  CurveCheck check;
  for (const PiecewisePolynomial& curve : parts) {
    check.segments += curve.segments();
    for (std::size_t i = 0; i < curve.segments(); ++i) {
      const core::SegmentPart part{.order = curve.order_of(i),
                                   .coefficients = curve.coefficients(i),
                                   .dimensions = curve.dimensions(),
                                   .from = 0,
                                   .to = curve.seconds(i)};
      take_segment(part, curve.left_of(i), limits, kinds, check);
    }
  }
  return check;
}

}  // namespace splinecast::apps
