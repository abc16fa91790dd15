#include "ipc/verification/stream_replay.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "ipc/ring/item.hpp"
#include "ipc/verification/difference.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

StreamReplay::StreamReplay(const StreamRecord& record, std::set<std::size_t> late_cuts)
    : record_(record),
      late_cuts_(std::move(late_cuts)),
      segments_(record.segments),
      decisions_(record),
      target_(record, decisions_.replacements()),
      begin_(record),
      solved_(record.items.dimensions()),
      end_(record.items.dimensions()),
      extrapolation_(record.items.dimensions()),
      path_(record.items.dimensions()),
      piece_(record.items.dimensions()),
      values_(record.items.dimensions()),
      begin_acceleration_(record.items.dimensions()) {}

Verification StreamReplay::run() {
  if (record_.is_part && !segments_.empty()) begin_part();
  while (!first_ && next_ < segments_.size()) solve_part();
  if (!first_ && record_.summary.finished && !ends_in_stop() && !rests_at_last_waypoint()) {
    (void)expect_all_used(record_.items.size());
  }
  return {.equal = equal_, .first = std::move(first_)};
}

/// Begins with the second segment: see StreamRecord.
void StreamReplay::begin_part() {
  next_ = 1;
  natural_right_ = segments_[0].natural_right;
  if (segments_.size() < 2 || !follows(1)) return;
  if (record_.restart == nullptr) {
    const bool is_entry = decisions_.is_entry(1);
    target_.skip_to(is_entry ? *segments_[1].origin.item : record_.items.size());
    if (!is_entry) (void)differ(1, "kind", in_words(segments_[1].kind), "entry");
    return;
  }
  target_.restart(*record_.restart);
  run_item_ = record_.restart->run_item;
  if (decisions_.is_ending(1) || decisions_.begins_run(1, run_item_)) return;
  if (segments_[1].kind != SegmentKind::hold || segments_[1].has_waypoint) solve_rest_of_run(1);
}

void StreamReplay::solve_part() {
  const std::size_t i = next_;
  if (!follows(i)) return;
  if (decisions_.is_ending(i)) return solve_ending(i);
  if (decisions_.begins_run(i, run_item_)) return solve_run(i);
  if (segments_[i].kind == SegmentKind::hold && !segments_[i].has_waypoint) return solve_hold(i);
  (void)differ(i, "kind: it belongs to no run", in_words(segments_[i].kind), "none");
}

/// Whether a segment begins where the one before it ends, and has the next number.
bool StreamReplay::follows(std::size_t i) {
  const SegmentCopy& segment = segments_[i];
  const Word number = i > 0 ? segments_[i - 1].next : segment.number;
  if (segment.number != number) {
    return differ(i, "number: segments between were lost before they were collected",
                  std::to_string(segment.number), std::to_string(number));
  }
  if (i == 0 || segment.left == segments_[i - 1].right) return true;
  return differ(i, "left end", in_words(segment.left), in_words(segments_[i - 1].right));
}

/// Solves the segments of one run: those on its target, and the entries that lead there.
void StreamReplay::solve_run(std::size_t i) {
  if (begin_run(i)) solve_rest_of_run(i);
}

/// Solves the segments of the current run from segment i on.
void StreamReplay::solve_rest_of_run(std::size_t i) {
  const std::size_t end = decisions_.end_of_run(i, run_item_);
  if (!list_met(i, end)) return;
  for (std::size_t s = i; s < end; ++s) {
    if (!follows(s) || !solve_in_run(s)) return;
    advance();
  }
  if (target_.window().knots() > 0 && is_last_run()) (void)append_until(record_.summary.run_knots);
}

bool StreamReplay::begin_run(std::size_t i) {
  const SegmentCopy& segment = segments_[i];
  const Word items = record_.items.size();
  begin_.find(i, natural_right_);
  const bool is_first_of_part = record_.is_part && i == 1 && record_.restart == nullptr;
  const bool is_later = i > 0 || decisions_.begins_elsewhere(i);
  // A run that has no waypoints yet remains the same run when it is cut again.
  const Word first_items = segment.origin.item.value_or(items);
  const bool is_same_run =
      i > 0 && !is_first_of_part && target_.window().knots() == 0 &&
      (target_.window().is_later_run() || !decisions_.replacements().find(0, first_items));
  bool begins_here = !is_same_run || decisions_.begins_at_cut(i);
  if (!begins_here && decisions_.may_begin_at_late_cut(i)) {
    begins_here = late_cuts_.contains(i);
    open_cut_ = begins_here ? std::nullopt : std::optional(i);
  } else {
    open_cut_.reset();
  }
  if (begins_here && (is_later || target_.window().is_later_run())) {
    target_.begin_run(begin_.at(segment.left));
  }
  target_.forget_waypoints();
  run_item_ = segment.origin.item;
  if (!run_item_ && segment.has_waypoint) {
    run_item_ = waypoint_at(segment.left);
  }
  if (!run_item_) return true;
  if (!expect_all_used(*run_item_)) return false;
  target_.list_waypoints(*run_item_);
  return true;
}

/// The waypoint with which the first run begins, if there is one. Those before it may have been
/// withdrawn: a law whose first revision is too late begins again.
std::optional<Word> StreamReplay::waypoint_at(Time time) const noexcept {
  const Word items = record_.items.size();
  auto item = record_.items.find(ItemKind::waypoint, target_.used(), items);
  while (item && record_.items.waypoint(*item).time != time) {
    item = record_.items.find(ItemKind::waypoint, *item + 1, items);
  }
  return item;
}

/// Lists the waypoints that the segments `begin` to `end` - 1 meet, with the number of newer ones
/// that were known when each was last solved.
bool StreamReplay::list_met(std::size_t begin, std::size_t end) {
  for (std::size_t s = begin; s < end; ++s) {
    const SegmentCopy& segment = segments_[s];
    if (segment.kind == SegmentKind::slowed) return note_slowed(s, end);
    if (segment.has_waypoint && !note_met(s, segment.left, segment.newer_knots)) return false;
    const bool arrives = segment.origin.ends_at_waypoint && segment.kind != SegmentKind::stop;
    if (arrives && !note_met(s, segment.natural_right, segment.origin.right_newer_knots)) {
      return false;
    }
  }
  return true;
}

bool StreamReplay::note_met(std::size_t s, Time time, std::size_t newer) {
  const auto index = target_.index_of(time);
  if (!index) return differ(s, "waypoint", in_words(time), "none of the run at that time");
  target_.note_met(*index, newer);
  return true;
}

/// Lists the waypoints that the slowed segments `s` to `end` - 1 meet. These have other times than
/// their waypoints, except the first one.
bool StreamReplay::note_slowed(std::size_t s, std::size_t end) {
  const auto first = target_.index_of(segments_[s].left);
  if (!first) return differ(s, "waypoint", in_words(segments_[s].left), "none of the run");
  for (std::size_t i = s; i < end; ++i) {
    const SegmentCopy& segment = segments_[i];
    if (segment.kind != SegmentKind::slowed || !segment.has_waypoint) {
      return differ(i, "kind after a slowed segment", in_words(segment.kind), "slowed");
    }
    target_.note_met(*first + (i - s), segment.newer_knots);
    target_.note_met(*first + (i - s) + 1, segment.origin.right_newer_knots);
  }
  return true;
}

/// Appends waypoints of the run until the target has `count` knots.
bool StreamReplay::append_until(std::size_t count) {
  if (target_.append_until(count)) return true;
  return differ(next_, "waypoints known", std::to_string(count),
                std::to_string(target_.window().knots()));
}

/// Whether the curve ends in a stop, so that it does not meet the last waypoints.
bool StreamReplay::ends_in_stop() const noexcept {
  if (record_.summary.ending() != EndKind::in_stop) return false;
  return !segments_.empty() &&
         (segments_.back().kind == SegmentKind::stop || segments_.back().kind == SegmentKind::hold);
}

/// Whether the last run has no segments, because the curve already rests at its last waypoint.
bool StreamReplay::rests_at_last_waypoint() {
  const Word run_item = record_.summary.run_item;
  if (segments_.empty() || run_item == 0 || run_item_ == run_item - 1) return false;
  if (!expect_all_used(run_item - 1)) return false;
  begin_.take_cut(segments_.size() - 1, segments_.back().right);
  target_.begin_run(begin_.at(segments_.back().right));
  target_.forget_waypoints();
  target_.list_waypoints(run_item - 1);
  const core::SlidingWindow& window = target_.window();
  return append_until(record_.summary.run_knots) && window.knots() > 0 &&
         same_bits(window.knot(window.knots() - 1).position, begin_.position());
}

/// Requires that each waypoint before item `end` is on the curve or was replaced. A plan of a law
/// takes the place of all waypoints before it.
bool StreamReplay::expect_all_used(Word end) {
  if (record_.items.is_taken(end, ItemKind::rate)) return true;
  auto missed = record_.items.find(ItemKind::waypoint, target_.used(), end);
  while (missed) {
    const auto replaced = decisions_.replacements().find(*missed, end);
    if (!replaced) break;
    missed = record_.items.find(ItemKind::waypoint, *replaced, end);
  }
  if (!missed) return true;
  const std::size_t last = segments_.empty() ? 0 : std::min(next_, segments_.size() - 1);
  return differ(last, std::string("waypoint of item ") + std::to_string(*missed), "none",
                in_words(record_.items.waypoint(*missed).time));
}

void StreamReplay::advance() noexcept {
  natural_right_ = solved_.right;
  ++next_;
  ++equal_;
}

bool StreamReplay::differ(std::size_t i, std::string what, std::string published,
                          std::string solved) {
  return differ(
      i, {.what = std::move(what), .published = std::move(published), .solved = std::move(solved)});
}

bool StreamReplay::differ(std::size_t i, Difference difference) {
  first_.emplace(std::move(difference));
  if (i < segments_.size()) {
    first_->segment = segments_[i].number;
    first_->left = segments_[i].left;
    first_->right = segments_[i].right;
  }
  return false;
}

}  // namespace splinecast::ipc
