#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "core/forms/entry.hpp"
#include "core/forms/knot_segment.hpp"
#include "core/forms/stop.hpp"
#include "core/motion/end.hpp"
#include "core/motion/entry_end.hpp"
#include "ipc/verification/difference.hpp"
#include "ipc/verification/stream_replay.hpp"

namespace splinecast::ipc {

/// Solves and compares segment s of the current run.
bool StreamReplay::solve_in_run(std::size_t s) {
  const SegmentCopy& segment = segments_[s];
  if (decisions_.is_entry(s)) return solve_entry(s);
  if (decisions_.is_after_entry(s)) return solve_after_entry(s);
  if (segment.kind == SegmentKind::slowed) return solve_slowed(s);
  if (segment.has_waypoint) return solve_on_target(s);
  return segment.kind == SegmentKind::hold ? solve_hold_after(s) : solve_state_stop(s);
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
  if (*index >= window.segments() || *index < window.oldest_segment()) {
    return differ(s, "kind: it belongs to no run", in_words(segment.kind), "none");
  }
  if (is_stop && *index + 1 == window.knots()) {
    window.write_acceleration(*index, values_);
    const core::Knot knot = window.knot(*index);
    const bool is_last = s + 1 == segments_.size();
    const bool is_shortest = is_last && record_.summary.ending() == EndKind::stopped;
    if (!solve_stop(s, {knot.time, knot.position, knot.velocity, values_},
                    is_shortest ? StopPart::shortest : StopPart::whole)) {
      return false;
    }
    if (!is_last) target_.leave_target_at(*index);
  } else {
    window.segment(*index, solved_);
    if (!compare_solved(s)) return false;
  }
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
    target_.window().segment(i, piece_);
    path_.add(target_.window().knot(i), core::part_of(piece_));
  }
  if (!append_until(knots)) return false;
  if (target_.plan().newest_time() - segments_[s].left > kLatestTime / 2) {
    return differ(s, "length of the path", in_words(target_.plan().newest_time()), "shorter");
  }
  path_.add_last(target_.window().knot(knots - 1));
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

/// Solves and compares a hold within a run. It begins at the uncut end of the segment before.
bool StreamReplay::solve_hold_after(std::size_t s) {
  const SegmentCopy& segment = segments_[s];
  if (s == 0 || segment.left != natural_right_) {
    return differ(s, "left end", in_words(segment.left), in_words(natural_right_));
  }
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
  return solve_stop(s, begin_.at(segments_[s].left), StopPart::whole);
}

/// Solves and compares a stop from a state: by the former rules, or as it was decided.
bool StreamReplay::solve_stop(std::size_t s, const Instant& from, StopPart part) {
  const SegmentCopy& segment = segments_[s];
  if (segment.left != from.time) {
    return differ(s, "left end", in_words(segment.left), in_words(from.time));
  }
  const core::StopRules rules = target_.window().stop_rules();
  if (has_former_rules()) {
    const bool is_whole = part != StopPart::remainder;
    const auto* const ahead = std::get_if<core::EnteringAhead>(&target_.plan().end());
    const Time length =
        is_whole || ahead == nullptr ? former_stop_time(rules, from) : ahead->after.stop_length();
    core::build_stop(from.time, length, from.position, from.velocity, from.acceleration, solved_);
    return compare_solved(s);
  }
  const Time length = recorded_length(segment);
  const std::size_t dimensions = from.position.size();
  if (segment.kind != SegmentKind::stop || segment.order != kMaxOrder || length <= Time::zero()) {
    return differ(s, "kind", in_words(segment.kind), in_words(SegmentKind::stop));
  }
  for (std::size_t d = 0; d < dimensions; ++d) {
    begin_acceleration_[d] = 2 * segment.coefficients[2 * dimensions + d];
  }
  const Instant begin{from.time, from.position, from.velocity, begin_acceleration_};
  core::build_stop(from.time, length, from.position, from.velocity, begin_acceleration_, solved_);
  if (!compare_solved(s)) return false;
  const auto broken = broken_promise(rules, begin, solved_, part);
  return broken.empty() || differ(s, std::string(broken), in_words(length),
                                  in_words(core::stop_time_within(rules, begin)));
}

/// How long the stop after the straight line takes to which entry s leads: as the record shows, if
/// it has that stop.
Time StreamReplay::stop_length_after(std::size_t s) const noexcept {
  const core::StopRules rules = target_.window().stop_rules();
  const Instant from = extrapolation_.line_end_state();
  if (has_former_rules()) return former_stop_time(rules, from);
  std::size_t i = s + 1;
  while (i < segments_.size() && i <= s + 2 && decisions_.is_after_entry(i) &&
         segments_[i].kind == SegmentKind::spline) {
    ++i;
  }
  const bool is_there = i < segments_.size() && decisions_.is_after_entry(i) &&
                        segments_[i].kind == SegmentKind::stop;
  const bool is_shorter = is_there && i == s + 1;
  if (is_there && segments_[i].natural_right > from.time &&
      !(is_shorter && recorded_length(segments_[i]) <= 2 * core::kLeastStopTime)) {
    return saturated_sum(segments_[i].natural_right, -from.time);
  }
  return core::stop_time_within(rules, from);
}

bool StreamReplay::solve_entry(std::size_t s) {
  const SegmentCopy& segment = segments_[s];
  begin_.find(s, natural_right_);
  core::EntryEnd end;
  if (segment.origin.ends_at_waypoint) {
    const auto index = target_.index_of(segment.natural_right);
    if (!index) return differ(s, "right end", in_words(segment.natural_right), "no waypoint");
    if (!append_until(*index + segment.newer_knots + 1)) return false;
    if (*index < target_.window().oldest_segment()) {
      return differ(s, "waypoints known", std::to_string(segment.newer_knots), "fewer");
    }
    end = core::end_at_knot(target_.window(), *index, end_);
  } else {
    if (!append_until(segment.origin.known)) return false;
    const Time newest = target_.plan().newest_time();
    const bool is_ahead = segment.natural_right >= newest &&
                          saturated_sum(segment.natural_right, -newest) <= kLatestTime;
    if (!is_ahead) return differ(s, "right end", in_words(segment.natural_right), in_words(newest));
    extrapolation_.begin_line(target_.window());
    extrapolation_.stop_after(stop_length_after(s));
    end = core::end_ahead(target_.window(), extrapolation_, segment.natural_right, end_);
  }
  target_.enter(end);
  core::build_entry(begin_.at(segment.left), end.state, solved_);
  return compare_solved(s);
}

/// Solves and compares the straight line or the stop after an entry beyond the newest waypoint.
bool StreamReplay::solve_after_entry(std::size_t s) {
  const core::Plan& plan = target_.plan();
  const auto* const ahead = std::get_if<core::EnteringAhead>(&plan.end());
  if (ahead == nullptr) return differ(s, "kind", in_words(segments_[s].kind), "none");
  const Instant stop = plan.stop_begin(*ahead, values_);
  if (segments_[s].kind == SegmentKind::spline) {
    const State& end = plan.entry_end();
    core::build_segment(core::SegmentForm::cubic,
                        {ahead->after.end, end.position(), end.velocity(), {}, {}},
                        {stop.time, stop.position, stop.velocity, {}, {}}, solved_);
    return compare_solved(s);
  }
  return solve_stop(s, stop, ahead->after.has_line() ? StopPart::whole : StopPart::remainder);
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
  target_.end_by_entry(segments_[i].natural_right);
  std::ranges::fill(values_, 0.0);
  core::build_entry(
      begin_.at(segments_[i].left),
      {segments_[i].natural_right, target_.plan().entry_end().position(), values_, values_},
      solved_);
  if (compare_solved(i)) advance();
}

bool StreamReplay::compare_solved(std::size_t i) {
  const bool may_be_cut = i + 1 < segments_.size() || !record_.summary.finished;
  auto difference = compare(segments_[i], solved_, record_.items.dimensions(), may_be_cut);
  if (!difference && i > 0) difference = compare_step(segments_[i - 1], segments_[i]);
  return difference ? differ(i, std::move(*difference)) : true;
}

}  // namespace splinecast::ipc
