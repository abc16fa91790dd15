#include "apps/record/watch/returns.hpp"

namespace splinecast::apps::record {
namespace {

bool is_on_waypoints(SegmentKind kind) noexcept {
  return kind == SegmentKind::spline || kind == SegmentKind::slowed;
}

/// The time of the first waypoint that a segment meets.
std::optional<Time> first_met(const ipc::SegmentCopy& segment) noexcept {
  if (segment.has_waypoint && is_on_waypoints(segment.kind)) return segment.left;
  // A stop is cut where the curve leaves it: it does not meet the waypoint that follows.
  const bool may_meet = is_on_waypoints(segment.kind) || segment.kind == SegmentKind::entry;
  const bool is_whole = segment.right == segment.natural_right;
  if (may_meet && is_whole && segment.origin.ends_at_waypoint) return segment.right;
  return std::nullopt;
}

}  // namespace

std::optional<Return> Returns::take(const ipc::SegmentCopy* before,
                                    const ipc::SegmentCopy& segment) noexcept {
  if (before == nullptr) {
    has_met_ = segment.number > 1;
    is_away_ = false;
  }
  const bool leaves = !is_on_waypoints(segment.kind) && has_met_ && !is_away_;
  if (leaves) {
    is_away_ = true;
    since_ = before != nullptr ? std::optional(segment.left) : std::nullopt;
  }
  if (segment.origin.item) run_item_ = *segment.origin.item;
  const std::optional<Time> met = first_met(segment);
  has_met_ = has_met_ || met || segment.has_waypoint;
  if (!met || !is_away_) return std::nullopt;
  is_away_ = false;
  return Return{.time = *met,
                .away = since_ ? std::optional(*met - *since_) : std::nullopt,
                .run_item = run_item_};
}

}  // namespace splinecast::apps::record
