#include <algorithm>

#include "core/limits/check.hpp"
#include "ipc/solve/published_curve.hpp"

/// Compares a published curve with the limits before a waypoint is taken.
namespace splinecast::ipc {

/// The first segment that an append may change and that the curve may follow. Excludes the first
/// kStartFades segments of a live stream that starts at rest: check_start() compares them with the
/// limits.
std::size_t PublishedCurve::first_compared() const noexcept {
  const bool starts_at_rest = !window_.is_later_run() && window_.options().held_before_start &&
                              window_.options().start.kind == ConditionKind::halt;
  const std::size_t frozen = window_.frozen_knots();
  return std::max({is_on_line() ? met_ : unmet_, frozen - std::min<std::size_t>(frozen, 1),
                   window_.oldest_segment(), starts_at_rest ? core::kStartFades : 0});
}

/// The knots from passed_first() on: another window needs them to continue this one.
std::span<const core::Knot> PublishedCurve::knots_to_go_on() noexcept {
  const std::size_t first = passed_first();
  for (std::size_t i = first; i < window_.knots(); ++i) knots_[i - first] = window_.knot(i);
  return std::span(knots_).first(window_.knots() - first);
}

std::optional<LimitExcess> PublishedCurve::find_excess(const Waypoint& waypoint) noexcept {
  const auto knots = knots_to_go_on();
  if (window_.is_later_run()) {
    trial_.restore_run(passed_first(), knots);
  } else {
    trial_.restore(passed_first(), knots);
  }
  trial_.freeze_knots(window_.frozen_knots());
  trial_.append(waypoint);
  const MotionLimits& limits = window_.options().limits;
  for (std::size_t i = std::max(first_compared(), trial_.oldest_segment()); i + 1 < trial_.knots();
       ++i) {
    trial_.segment(i, segment_);
    if (core::keeps_within(limits, &kinds_, segment_)) continue;
    const Excess found = core::worst_excess(limits, &kinds_, segment_);
    const Time left = segment_.left;
    if (i + 1 < window_.knots()) {
      window_.segment(i, segment_);
      if (!core::keeps_within(limits, &kinds_, segment_)) continue;
    }
    return LimitExcess{.kind = found.kind,
                       .dimension = found.dimension,
                       .time = left + from_seconds(found.u),
                       .value = found.value,
                       .limit = found.limit};
  }
  return std::nullopt;
}

}  // namespace splinecast::ipc
