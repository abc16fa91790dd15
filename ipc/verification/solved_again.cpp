#include <algorithm>
#include <string>
#include <utility>

#include "core/forms/entry.hpp"
#include "core/forms/knot_segment.hpp"
#include "core/forms/stop.hpp"
#include "ipc/verification/difference.hpp"
#include "ipc/verification/stream_replay.hpp"

namespace splinecast::ipc {

/// Solves and compares segment s of the current run.
bool StreamReplay::solve_in_run(std::size_t s) {
  const SegmentCopy& segment = segments_[s];
  if (decisions_.is_entry(s)) return solve_entry(s);
  if (decisions_.is_behind_entry(s)) return solve_behind_entry(s);
  if (segment.kind == SegmentKind::slowed) return solve_slowed(s);
  if (segment.has_waypoint) return solve_on_target(s);
  return segment.kind == SegmentKind::hold ? solve_hold_behind(s) : solve_state_stop(s);
}

/// Solves and compares a segment of the target, or the stop after its newest waypoint.
bool StreamReplay::solve_on_target(std::size_t s) {
  const SegmentCopy& segment = segments_[s];
  const core::SlidingWindow& window = target_.window();
  const auto index = target_.index_of(segment.left);
  if (!index) return differ(s, "left end", in_words(segment.left), "no waypoint");
  const bool is_stop = segment.kind == SegmentKind::stop;
  const auto newest = target_.newest_of(is_stop ? *index : *index + 1);
  if (!append_until((newest ? *newest : *index) + 1)) return false;
  if (is_last_run()) target_.finish_last_run();
  if (*index >= window.segments()) {
    return differ(s, "kind: it belongs to no run", in_words(segment.kind), "none");
  }
  window.segment(*index, solved_);
  if (!compare_solved(s)) return false;
  if (same_bits(window.knot(*index).waypoint, segment.waypoint)) return true;
  return differ(s, "waypoint", first_in_words(segment.waypoint),
                first_in_words(window.knot(*index).waypoint));
}

/// Solves the path from segment s on, at which the curve begins to slow down.
bool StreamReplay::solve_path(std::size_t s) {
  slowed_ = s;
  const auto first = target_.index_of(segments_[s].left);
  const Word knots = record_.summary.run_knots;
  if (!first || s == 0 || !is_last_run() || *first + 1 >= knots) {
    return differ(s, "kind", in_words(segments_[s].kind), "none: it is not the end of a run");
  }
  const SegmentCopy& before = segments_[s - 1];
  core::evaluate_derivative(before.order, before.coefficients,
                            to_seconds(before.natural_right - before.left), 2, path_.reached());
  for (std::size_t i = *first; i + 1 < knots; ++i) {
    const auto newest = target_.newest_of(i + 1);
    if (!append_until(newest ? *newest + 1 : knots)) return false;
    if (i < target_.window().oldest_segment() || i + 1 >= target_.window().knots()) {
      return differ(s, "kind", in_words(segments_[s].kind), "none: it has no path");
    }
    path_.add(target_.window(), i);
  }
  if (!append_until(knots)) return false;
  path_.add_last(target_.window());
  return true;
}

/// Solves and compares a segment of a path on which the curve slows down.
bool StreamReplay::solve_slowed(std::size_t s) {
  if (path_.knots() == 0 && !solve_path(s)) return false;
  const std::size_t piece = s - slowed_;
  if (piece + 1 >= path_.knots()) {
    return differ(s, "kind: it belongs to no run", in_words(segments_[s].kind), "none");
  }
  path_.build(piece, solved_);
  if (!compare_solved(s)) return false;
  if (same_bits(path_.waypoint(piece), segments_[s].waypoint)) return true;
  return differ(s, "waypoint", first_in_words(segments_[s].waypoint),
                first_in_words(path_.waypoint(piece)));
}

/// Solves and compares a hold within a run. It begins at the published end of the segment before.
bool StreamReplay::solve_hold_behind(std::size_t s) {
  const SegmentCopy& segment = segments_[s];
  begin_.take_cut(s - 1, segment.left);
  core::build_hold(segment.left, segment.right, begin_.position(), solved_);
  return compare_solved(s);
}

/// Solves and compares a hold that belongs to no run. It must begin at the uncut end of the segment
/// before.
void StreamReplay::solve_hold(std::size_t i) {
  begin_.take_cut(i - 1, segments_[i].left);
  core::build_hold(segments_[i].left, segments_[i].right, begin_.position(), solved_);
  if (segments_[i].left != natural_right_) {
    (void)differ(i, "left end", in_words(segments_[i].left), in_words(natural_right_));
  } else if (compare_solved(i)) {
    advance();
  }
}

/// Solves and compares the stop from the state at which a run begins.
bool StreamReplay::solve_state_stop(std::size_t s) {
  const core::WindowOptions& options = target_.window().options();
  const Time length = core::stop_time_within(options.limits, options.stop_time, begin_.velocity(),
                                             begin_.acceleration());
  core::build_stop(segments_[s].left, length, begin_.position(), begin_.velocity(),
                   begin_.acceleration(), solved_);
  return compare_solved(s);
}

bool StreamReplay::solve_entry(std::size_t s) {
  const SegmentCopy& segment = segments_[s];
  begin_.find(s, natural_right_);
  Instant end = begin_.at(segment.natural_right);
  if (segment.origin.ends_at_waypoint) {
    const auto index = target_.index_of(segment.natural_right);
    if (!index) return differ(s, "right end", in_words(segment.natural_right), "no waypoint");
    if (!append_until(*index + segment.newer_knots + 1)) return false;
    target_.freeze(*index + 1);
    const core::Knot knot = target_.window().knot(*index);
    target_.window().write_acceleration(*index, end_.ref().acceleration);
    end.position = knot.position;
    end.velocity = knot.velocity;
  } else {
    if (!append_until(segment.origin.known)) return false;
    extrapolation_.begin(target_.window());
    extrapolation_.state_at(end.time, end_.ref());
    end.position = end_.position();
    end.velocity = end_.velocity();
    behind_ = {
        .end = end.time, .line_end = extrapolation_.line_end(), .rest = extrapolation_.rest()};
  }
  end.acceleration = end_.acceleration();
  core::build_entry(begin_.at(segment.left), end, solved_);
  return compare_solved(s);
}

/// Solves and compares the straight line or the stop after an entry beyond the newest waypoint.
bool StreamReplay::solve_behind_entry(std::size_t s) {
  const auto position = std::span(values_);
  const bool is_line = segments_[s].kind == SegmentKind::spline;
  behind_.write_line_end(end_.position(), end_.velocity(), position);
  if (is_line) {
    core::build_segment(core::SegmentForm::cubic,
                        {behind_.end, end_.position(), end_.velocity(), {}, {}},
                        {behind_.line_end, position, end_.velocity(), {}, {}}, solved_);
  } else {
    core::build_stop(behind_.stop_begin(), behind_.stop_length(),
                     behind_.has_line() ? position : end_.position(), end_.velocity(),
                     end_.acceleration(), solved_);
  }
  return compare_solved(s);
}

/// Whether the entry that ends the curve is the first one of its run.
bool StreamReplay::begins_at_end(std::size_t i) const noexcept {
  return decisions_.is_ending(i) && segments_[i].origin.item &&
         run_item_ != segments_[i].origin.item;
}

/// Solves and compares the entry by which a curve ends at its last waypoint.
void StreamReplay::solve_ending(std::size_t i) {
  if (begins_at_end(i) && !begin_run(i)) return;
  if (run_item_ && !append_until(record_.summary.run_knots)) return;
  if (target_.window().knots() == 0) {
    return (void)differ(i, "kind: it belongs to no run", in_words(segments_[i].kind), "none");
  }
  begin_.find(i, natural_right_);
  const core::Knot knot = target_.window().knot(target_.window().knots() - 1);
  std::ranges::fill(values_, 0.0);
  const auto zeros = std::span(values_).first(target_.window().dimensions());
  core::build_entry(begin_.at(segments_[i].left),
                    {segments_[i].natural_right, knot.position, zeros, zeros}, solved_);
  if (compare_solved(i)) advance();
}

bool StreamReplay::compare_solved(std::size_t i) {
  const bool may_be_cut = i + 1 < segments_.size() || !record_.summary.finished;
  auto difference = compare(segments_[i], solved_, record_.items.dimensions(), may_be_cut);
  return difference ? differ(i, std::move(*difference)) : true;
}

}  // namespace splinecast::ipc
