#include "ipc/roles/replace_preview.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/forms/stop.hpp"
#include "core/limits/extremes.hpp"
#include "core/limits/limit_of.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast::ipc {
namespace {

constexpr int kTries = 16;

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

ReplacementPlanner::ReplacementPlanner(const KnotBoardReader& board, core::WindowOptions options,
                                       DimensionKinds kinds, const std::optional<LiveOptions>& live)
    : board_(&board),
      options_(std::move(options)),
      kinds_(std::move(kinds)),
      min_entry_(live ? live->min_entry : Time::zero()),
      is_live_(live.has_value()),
      sampler_(board, is_live_ ? StreamClock::monotonic : StreamClock::recorded, kinds_),
      shown_(board),
      window_(board.dimensions(), core::with_kinds(options_, kinds_)),
      search_(board.dimensions(), kinds_),
      reach_(board.dimensions()),
      state_(board.dimensions()),
      segment_(board.dimensions()),
      values_(3 * board.dimensions()) {}

/// Reads the state at t and the shown motion before t. Returns false if the board has no state at t
/// or the writer overtook every try.
bool ReplacementPlanner::read_state(Time t) {
  if (!has_values(sampler_.preview(t, state_.ref()))) return false;
  Summary summary;
  for (int i = 0; i < kTries; ++i) {
    if (!board_->copy_summary(board_->look(), summary)) continue;
    window_.begin_run();
    shown_.restore(*board_, summary, Time::max());
    shown_.replace_from_next();
    return true;
  }
  return false;
}

/// Appends a waypoint as its representative nearest to the one before, as the solver does.
void ReplacementPlanner::append(const Waypoint& waypoint) {
  const std::size_t dimensions = window_.dimensions();
  const auto copy = [&](std::size_t part, std::span<const double> from) {
    const auto to = std::span(values_).subspan(part * dimensions, from.size());
    std::ranges::copy(from, to.begin());
    return to;
  };
  const WaypointValues values{.position = copy(0, waypoint.position),
                              .velocity = copy(1, waypoint.velocity),
                              .acceleration = copy(2, waypoint.acceleration)};
  const std::size_t knots = window_.knots();
  kinds_.continue_from(knots > 0 ? window_.knot(knots - 1).waypoint : state_.position(), values);
  window_.append({.time = waypoint.time,
                  .position = values.position,
                  .velocity = values.velocity,
                  .acceleration = values.acceleration});
  if (is_live_) shown_.note(waypoint.time, values.position);
}

void ReplacementPlanner::take(const core::Segment& segment, MotionPeaks* entry,
                              ReplacePreview& out) const {
  const core::SegmentPart part = core::part_of(segment);
  take_peaks(part, out.motion);
  if (entry != nullptr) take_peaks(part, *entry);
  const Excess excess = core::worst_excess(options_.limits, &kinds_, part);
  if (excess.ratio > out.worst.ratio) out.worst = excess;
}

void ReplacementPlanner::take_stop(ReplacePreview& out, const Instant& from) {
  const Time length = core::build_stop_within(window_.stop_rules(), from, segment_);
  take(segment_, out.enters ? nullptr : &out.entry, out);
  if (!out.enters) out.duration = length;
}

/// Adds the entry that was found, and the stop after it, to the preview.
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
  const std::size_t knots = window_.knots();
  const bool meets_last = end.state.time == window_.time(knots - 1);
  if (meets_last) out.waypoint = knots - 1;
  out.passed_over = knots - (meets_last ? 1 : 0);
  take_stop(out, end.state);  // the straight line before the stop adds no peaks
}

/// Adds the target's segments after the entry, up to number `end`, before they leave the window.
void ReplacementPlanner::take_segments(std::size_t end, ReplacePreview& out) {
  for (; next_segment_ && *next_segment_ < end; ++*next_segment_) {
    window_.segment(*next_segment_, segment_);
    take(segment_, nullptr, out);
  }
}

/// Appends the waypoints and searches for an entry after each, as the solver does; then once more,
/// as if no newer waypoints come.
bool ReplacementPlanner::find_entry(const Instant& from, std::span<const Waypoint> waypoints,
                                    Time blend, ReplacePreview& out) {
  core::EntryRules rules{.limits = &window_.limits_at_largest_rate(),
                         .path_limits = &options_.limits,
                         .shown = is_live_ ? &shown_.limits() : nullptr,
                         .least = std::max(min_entry_, blend),
                         .newer = options_.settle,
                         .reach = &reach_};
  (void)core::build_stop_within(window_.stop_rules(), from, segment_);
  reach_.restart(from.position);
  reach_.add(core::part_of(segment_));
  bool is_found = false;
  const auto search = [&] {
    constexpr int kAll = 1000;
    int tries = kAll;
    if (is_live_) shown_.look(options_.stop_time);
    is_found = search_.search(window_, from, rules, tries) == core::EntrySearch::Outcome::found;
    if (!is_found) return;
    take_entry(out);
    if (out.waypoint && next_segment_) window_.freeze_knots(*out.waypoint + 1);
  };
  search_.restart(0);
  next_segment_.reset();
  for (const Waypoint& waypoint : waypoints) {
    append(waypoint);
    if (!is_found) search();
    take_segments(window_.settled_segments(), out);
  }
  if (!is_found && !waypoints.empty() && is_live_) {
    rules.goes_beyond = true;
    rules.newer = 0;
    search();
  }
  take_segments(window_.segments(), out);
  return is_found;
}

void ReplacementPlanner::plan(std::span<const Waypoint> waypoints, Time blend,
                              ReplacePreview& out) {
  out.is_known = read_state(out.begin);
  if (out.from_rest) come_to_rest(state_);
  core::clamp_acceleration(window_.limits_at_largest_rate(), kinds_, state_.velocity(),
                           state_.ref().acceleration);
  out.duration = {};
  out.enters = false;
  out.waypoint.reset();
  out.passed_over = 0;
  out.worst = {};
  clear(out.entry, window_.dimensions());
  clear(out.motion, window_.dimensions());
  if (!out.is_known) return;
  const Instant from{out.begin, state_.position(), state_.velocity(), state_.acceleration()};
  if (find_entry(from, waypoints, blend, out)) return;
  out.passed_over = waypoints.size();
  take_stop(out, from);
}

std::optional<ReplacementBegin> begin_of_run(const KnotBoardReader& board, Word item) {
  Summary summary;
  if (!board.copy_newest_summary(summary) || summary.consumed <= item || summary.newest == 0) {
    return std::nullopt;
  }
  std::array<RefusedItem, kRefusalsKept> refused;  // NOLINT(*-member-init)
  const Word kept = std::min<Word>(summary.refused, kRefusalsKept);
  const std::size_t count = board.copy_refusals(summary, summary.refused - kept, refused);
  const auto known = std::span(refused).first(count);
  const bool is_refused = std::ranges::find(known, item, &RefusedItem::item) != known.end();
  if (is_refused) return std::nullopt;
  KnotCopy knot(board.dimensions(), board.smooths());
  if (!board.copy_knot(summary.run, summary.revision, knot)) return std::nullopt;
  return ReplacementBegin{.begin = knot.time, .from_rest = knot.note.is_corner};
}

}  // namespace splinecast::ipc
