#include <algorithm>

#include "core/limits/check.hpp"
#include "ipc/solve/published_curve.hpp"

/// Compares a published curve with the limits before a waypoint is taken.
namespace splinecast::ipc {

/// The first segment that is not frozen and that the published curve may still follow. A curve that
/// is not on the target can follow only segments after its next entry, which begins at `settled` or
/// later.
std::size_t PublishedCurve::first_open(Time settled) const noexcept {
  const std::size_t frozen = window_.frozen_knots();
  std::size_t first =
      std::max({is_on_line() ? met_ : unmet_, frozen - std::min<std::size_t>(frozen, 1),
                window_.oldest_segment()});
  if (is_on_line()) return first;
  const Time begin = origin_.number > 0 ? std::max(settled, origin_.time) : settled;
  const Time earliest = std::max(begin + entries_.min_entry, blend_until_);
  while (first < window_.knots() && window_.time(first) < earliest) ++first;
  return first;
}

/// The first segment to be compared when a waypoint is appended. Excludes the first kStartFades
/// segments of a live stream that starts at rest: check_start() compares them with the limits.
std::size_t PublishedCurve::first_compared(Time settled) const noexcept {
  const bool starts_at_rest = !window_.is_later_run() && window_.options().held_before_start &&
                              window_.options().start.kind == ConditionKind::halt;
  return std::max(
      {first_open(settled), trial_.oldest_segment(), starts_at_rest ? core::kStartFades : 0});
}

/// The knots from passed_first() on: another window needs them to continue this one.
std::span<const core::Knot> PublishedCurve::knots_to_go_on() noexcept {
  const std::size_t first = passed_first();
  for (std::size_t i = first; i < window_.knots(); ++i) knots_[i - first] = window_.knot(i);
  return std::span(knots_).first(window_.knots() - first);
}

/// Makes trial_ a copy of the window.
void PublishedCurve::begin_trial() noexcept {
  const auto knots = knots_to_go_on();
  if (window_.is_later_run()) {
    trial_.restore_run(passed_first(), knots);
  } else {
    trial_.restore(passed_first(), knots);
  }
  trial_.freeze_knots(window_.frozen_knots());
}

std::optional<LimitExcess> PublishedCurve::find_excess(const Waypoint& waypoint,
                                                       Time settled) noexcept {
  begin_trial();
  trial_.append(waypoint);
  const MotionLimits& limits = window_.options().limits;
  std::optional<LimitExcess> worst;
  double ratio = 0;
  for (std::size_t i = first_compared(settled); i + 1 < trial_.knots(); ++i) {
    trial_.segment(i, segment_);
    if (core::keeps_within(limits, &kinds_, segment_)) continue;
    const Excess found = core::worst_excess(limits, &kinds_, segment_);
    const Time left = segment_.left;
    if (i + 1 < window_.knots()) {
      window_.segment(i, segment_);
      if (!core::keeps_within(limits, &kinds_, segment_)) continue;
    }
    if (found.ratio <= ratio) continue;
    ratio = found.ratio;
    worst = LimitExcess{.kind = found.kind,
                        .dimension = found.dimension,
                        .time = left + from_seconds(found.u),
                        .value = found.value,
                        .limit = found.limit};
  }
  return worst;
}

}  // namespace splinecast::ipc
