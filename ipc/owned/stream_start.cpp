#include "ipc/owned/stream_start.hpp"

#include <algorithm>
#include <chrono>
#include <new>

#include "core/limits/limit_of.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/ring/item.hpp"

namespace splinecast::ipc {
namespace {

/// With a shorter lead the first waypoint may have settled when the solver takes it, and is refused
/// then. A start state that comes late is not refused.
constexpr Time kAmpleLead = std::chrono::milliseconds(100);

}  // namespace

StreamStart::StreamStart(const std::string& stream, const OwnedRing& ring,
                         const ProducerOptions& options)
    : zeros_(ring.header.dimensions),
      max_rate_(max_rate(ring.header)),
      longest_interval_(interval_range(ring.header).most) {
  if (ring.writer.has_begun()) return;
  old_ = OldEnd::find(stream, ring.header, options.start_tolerance, options.trust);
}

/// The limits of the first motion at each rate of a law: those of the solver or, until one has
/// attached, of the old stream.
MotionLimits StreamStart::limits(const RegionHeader* board) const {
  return core::limits_at_rate(board != nullptr ? window_options(*board).limits : old_->limits(),
                              max_rate_);
}

Instant StreamStart::state(const Solved& known) const noexcept {
  return {.time = std::max({known.clock->now(), known.settled_until, old_->rest()}),
          .position = old_->position(),
          .velocity = zeros_,
          .acceleration = zeros_};
}

/// Compares a first waypoint that has been checked with the old end, and appends the start state if
/// the curve starts there. `replaced_from`: where a replacement begins.
AppendStatus StreamStart::begin(const Waypoint& first, std::optional<Time> replaced_from,
                                WaypointRingWriter& writer, const Solved& known,
                                const RegionHeader* board) noexcept {
  try {
    const auto known_end = old_->look();
    if (known_end == OldEnd::Known::no) return AppendStatus::accepted;
    if (known_end == OldEnd::Known::not_yet) return writer.counted(AppendStatus::elsewhere);
    Instant at = state(known);
    at.time = std::max(at.time, first.time - longest_interval_);
    const Time from = std::max(at.time, replaced_from.value_or(at.time));
    const OldEnd::Way way = old_->way_to(first.position, first.time - from, limits(board));
    if (way == OldEnd::Way::elsewhere) return writer.counted(AppendStatus::elsewhere);
    const Time lead = first.time - from;  // negative only with a simulated clock
    const bool is_ample = lead < Time::zero() || lead >= kAmpleLead;
    if (way == OldEnd::Way::there && is_ample) return AppendStatus::accepted;
    at.time = std::min(at.time, replaced_from.value_or(at.time));
    return writer.start_from(at, known);
  } catch (const std::bad_alloc&) {
    return writer.counted(AppendStatus::elsewhere);
  }
}

AppendStatus StreamStart::started(AppendStatus status) noexcept {
  if (status == AppendStatus::accepted) old_.reset();
  return status;
}

AppendStatus StreamStart::append(const Waypoint& waypoint, WaypointRingWriter& writer,
                                 const Solved& known, const RegionHeader* board) noexcept {
  AppendStatus status = writer.check(waypoint, known);
  if (status != AppendStatus::accepted) return writer.counted(status);
  status = begin(waypoint, {}, writer, known, board);
  return status == AppendStatus::accepted ? started(writer.append(waypoint, known)) : status;
}

AppendStatus StreamStart::replace_from(Time t, const ReplacementPath& waypoints, Time blend,
                                       WaypointRingWriter& writer, const Solved& known,
                                       const RegionHeader* board) noexcept {
  if (waypoints.empty()) return writer.replace_from(t, waypoints, known);
  AppendStatus status = writer.check_replacement(t, waypoints, known, blend);
  if (status != AppendStatus::accepted) return writer.counted(status);
  const bool is_soonest = t == WaypointRingWriter::kSoonest;
  status =
      begin(waypoints.front(), is_soonest ? std::nullopt : std::optional(t), writer, known, board);
  if (status != AppendStatus::accepted) return status;
  return started(writer.replace_from(t, waypoints, known, blend));
}

AppendStatus StreamStart::start_from(const Instant& state, const StartOptions& how,
                                     WaypointRingWriter& writer, const Solved& known) noexcept {
  const bool has_position = state.position.size() == zeros_.size() && is_finite(state.position);
  try {
    const auto known_end = old_ && has_position ? old_->look() : OldEnd::Known::no;
    const bool may_start =
        known_end == OldEnd::Known::no ||
        (known_end == OldEnd::Known::yes && (how.moved || old_->is_near(state.position)));
    if (!may_start) return writer.counted(AppendStatus::elsewhere);
    const bool has_position_only = state.velocity.empty() && state.acceleration.empty();
    if (how.moved && has_position && has_position_only && !writer.has_begun()) {
      if (old_) old_->move_to(state.position);
      return AppendStatus::accepted;
    }
  } catch (const std::bad_alloc&) {
    return writer.counted(AppendStatus::elsewhere);
  }
  return started(writer.start_from(state, known));
}

std::string StreamStart::why_elsewhere(const Waypoint& first, const Solved& known,
                                       const RegionHeader* board) {
  if (first.position.size() != zeros_.size()) return {};
  return old_->why_elsewhere(first.position, first.time - state(known).time, limits(board));
}

}  // namespace splinecast::ipc
