#include "ipc/roles/replace_preview.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "core/forms/instant.hpp"
#include "core/forms/stop.hpp"
#include "core/limits/extremes.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast::ipc {
namespace {

constexpr int kTries = 16;
constexpr int kAllCandidates = 1000;

void clear(MotionPeaks& peaks, std::size_t dimensions) {
  peaks.velocity.assign(dimensions, 0);
  peaks.acceleration.assign(dimensions, 0);
  peaks.jerk.assign(dimensions, 0);
}

void take_peaks(const core::SegmentPart& part, MotionPeaks& peaks) {
  for (std::size_t d = 0; d < part.dimensions; ++d) {
    std::array<core::SegmentRange, 4> ranges;
    core::write_ranges(
        part, d, Derivatives::velocity | Derivatives::acceleration | Derivatives::jerk, ranges);
    const auto take = [&](double& peak, const core::SegmentRange& range) {
      peak = std::max(peak, std::abs(range.largest().value));
    };
    take(peaks.velocity[d], ranges[1]);
    take(peaks.acceleration[d], ranges[2]);
    take(peaks.jerk[d], ranges[3]);
  }
}

}  // namespace

ReplacementPlanner::ReplacementPlanner(const KnotBoardReader& board,
                                       const core::WindowOptions& options,
                                       const DimensionKinds& kinds,
                                       const std::optional<LiveOptions>& live, Beyond beyond)
    : board_(&board),
      sampler_(board, live ? StreamClock::monotonic : StreamClock::recorded),
      shown_(board),
      plan_(board.dimensions(), core::with_kinds(options, kinds)),
      search_(board.dimensions(), plan_.window().options(),
              {.is_live = live.has_value(),
               .least_entry = live ? live->least_entry : Time::zero(),
               .keeps_limits = live && beyond == Beyond::enter,
               .checks_stops = live && beyond != Beyond::report}),
      state_(board.dimensions()),
      segment_(board.dimensions()) {}

/// Reads the state at t and the shown motion before t. Returns false if the board has no state at t
/// or the writer overtook every try.
bool ReplacementPlanner::read_state(Time t) {
  const StateRef state = state_.ref();
  if (!has_values(sampler_.preview(t, state))) return false;
  // As the solver, on the turn on which the curve is.
  plan_.window().kinds().normalise_quaternions(state.position, state.velocity, state.acceleration);
  Summary summary;
  for (int i = 0; i < kTries; ++i) {
    if (!board_->copy_summary(board_->look(), summary)) continue;
    shown_.restore(*board_, summary, Time::max());
    shown_.replace_from_next();
    return true;
  }
  return false;
}

void ReplacementPlanner::take(const core::Segment& segment, MotionPeaks* entry,
                              ReplacePreview& out) const {
  const core::SegmentPart part = core::part_of(segment);
  take_peaks(part, out.motion);
  if (entry != nullptr) take_peaks(part, *entry);
  const core::SlidingWindow& window = plan_.window();
  const Excess excess = core::worst_excess(window.options().limits, &window.kinds(), part);
  if (excess.ratio > out.worst.ratio) out.worst = excess;
}

/// Adds the stop from the begin of the run, if no entry was found.
void ReplacementPlanner::take_stop(ReplacePreview& out) {
  out.duration = core::build_stop_within(plan_.window().stop_rules(), plan_.origin(), segment_);
  take(segment_, &out.entry, out);
}

/// Adds the entry that was found to the preview.
void ReplacementPlanner::take_entry(ReplacePreview& out) {
  const core::EntryEnd& end = search_.end();
  out.enters = true;
  out.duration = end.state.time - out.begin;
  out.waypoint = end.knot;
  take(search_.entry(), &out.entry, out);
  if (end.knot) {
    out.passed_over = *end.knot;
    next_segment_ = *end.knot;
    return;
  }
  const std::size_t knots = plan_.window().knots();
  const bool meets_last = end.state.time == plan_.newest_time();
  if (meets_last) out.waypoint = knots - 1;
  out.passed_over = knots - (meets_last ? 1 : 0);
}

/// Adds the target's segments after the entry, up to number `end`, before they leave the window.
void ReplacementPlanner::take_segments(std::size_t end, ReplacePreview& out) {
  for (; next_segment_ && *next_segment_ < end; ++*next_segment_) {
    plan_.window().segment(*next_segment_, segment_);
    take(segment_, nullptr, out);
  }
}

/// Searches for the plan's entry and adds it. `is_last`: no newer waypoints come.
bool ReplacementPlanner::search(bool is_last, ReplacePreview& out) {
  const bool is_live = search_.options().is_live;
  if (is_live) shown_.look(plan_.window().options().stop_length);
  int tries = kAllCandidates;
  const core::EntryBegin from{plan_.origin(), is_live ? &shown_.limits() : nullptr};
  if (search_.search(plan_, from, is_last, tries) != core::PlanSearch::Outcome::found) return false;
  take_entry(out);
  plan_.enter(search_.end(), std::nullopt);
  // The straight line before the stop adds no peaks.
  if (const auto* const ahead = std::get_if<core::EnteringAhead>(&plan_.end())) {
    const Instant stop = plan_.stop_begin(*ahead, state_.ref().position);
    core::build_stop(stop.time, plan_.stop_after_entry(*ahead), stop.position, stop.velocity,
                     stop.acceleration, segment_);
    take(segment_, nullptr, out);
  }
  return true;
}

/// Appends the waypoints and searches for an entry after each, as the solver does; then once more,
/// as if no newer waypoints come.
bool ReplacementPlanner::find_entry(std::span<const Waypoint> waypoints, ReplacePreview& out) {
  (void)core::build_stop_within(plan_.window().stop_rules(), plan_.origin(), segment_);
  search_.reach().restart(plan_.origin().position);
  search_.reach().add(core::part_of(segment_));
  search_.restart(plan_);
  next_segment_.reset();
  bool is_found = false;
  for (const Waypoint& given : waypoints) {
    const Waypoint waypoint = plan_.nearest(given);
    plan_.append(waypoint);
    if (search_.options().is_live) shown_.note(waypoint.time, waypoint.position);
    is_found = is_found || search(false, out);
    take_segments(plan_.window().settled_segments(), out);
  }
  if (!is_found && !waypoints.empty() && search_.options().is_live) is_found = search(true, out);
  take_segments(plan_.window().segments(), out);
  return is_found;
}

void ReplacementPlanner::plan(std::span<const Waypoint> waypoints, Time blend,
                              ReplacePreview& out) {
  const std::size_t dimensions = plan_.window().dimensions();
  out.is_known = read_state(out.begin);
  out.duration = {};
  out.enters = false;
  out.waypoint.reset();
  out.passed_over = 0;
  out.worst = {};
  clear(out.entry, dimensions);
  clear(out.motion, dimensions);
  if (!out.is_known) return;
  if (out.from_rest) come_to_rest(state_);
  plan_.cut(core::instant_of(out.begin, state_), blend);
  if (find_entry(waypoints, out)) return;
  out.passed_over = waypoints.size();
  take_stop(out);
}

std::optional<ReplacementBegin> begin_of_run(const KnotBoardReader& board, Word item) {
  Summary summary;
  if (!board.copy_newest_summary(summary) || summary.consumed <= item || summary.newest == 0) {
    return std::nullopt;
  }
  std::array<RefusalRecord, kRefusalsKept> refused;  // NOLINT(*-member-init)
  const Word kept = std::min<Word>(summary.refused, kRefusalsKept);
  const std::size_t count = board.copy_refusals(summary, summary.refused - kept, refused);
  const auto known = std::span(refused).first(count);
  const bool is_refused = std::ranges::find(known, item, &RefusalRecord::item) != known.end();
  if (is_refused) return std::nullopt;
  KnotCopy knot(board.dimensions(), board.smooths());
  if (!board.copy_knot(summary.run, summary.revision, knot)) return std::nullopt;
  return ReplacementBegin{.begin = knot.time, .from_rest = knot.note.is_corner};
}

}  // namespace splinecast::ipc
