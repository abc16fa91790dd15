#include "tests/campaign/streams/revision_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "ipc/verification/verify.hpp"

#include "core/limits/extremes.hpp"

namespace splinecast::campaign {

using ipc::ItemKind;
using ipc::Summary;
using ipc::Word;

RevisionCheck::RevisionCheck(const StreamPlan& plan, testing::MemoryStream& stream,
                             StreamFindings& findings)
    : plan_(&plan),
      stream_(&stream),
      findings_(&findings),
      rules_(plan.kinds, plan.dimensions.size()),
      items_(plan.dimensions.size()),
      settled_(stream.board.reader, true),
      board_segment_(plan.dimensions.size(), stream.board.reader.smooths()) {}

void RevisionCheck::breach(Breach breach, const std::string& what) {
  findings_->breach(
      breach, fmt::format("{}, revision {}: course {}, {} of {} waypoints met, unmet {}, newest {}",
                          what, summary_.revision, summary_.course, summary_.met,
                          summary_.run_knots, summary_.unmet, summary_.newest));
}

void RevisionCheck::look(Time now, bool is_complete) {
  const auto& board = stream_->board.reader;
  const ipc::Look look = board.look();
  const Summary before = summary_;
  if (!board.copy_summary(look, summary_)) {
    if (look.revision == 0) return;
    return findings_->breach(Breach::board_refused,
                             fmt::format("no summary of revision {}", look.revision));
  }
  // A solver that dies right after its commit has not stored the new `settled_until`.
  check_settled_until(before, is_complete ? now : Time::min());
  if (look.revision == before.revision) {
    settled_.look();
    return check_settled_segments();
  }
  items_.note_refusals(board, summary_.refused);
  findings_->count(Event::revisions);
  check_counts(before);
  take_items(before);
  check_end();
  check_verifiable();
  count_events(before);
  settled_.look();
  check_settled_segments();
}

void RevisionCheck::check_counts(const Summary& before) {
  const bool adds_up =
      summary_.consumed ==
          summary_.knots + summary_.refused + summary_.withdrawn + summary_.controls &&
      summary_.refused == std::reduce(summary_.reasons.begin(), summary_.reasons.end()) &&
      summary_.passed_over <= summary_.knots && summary_.consumed >= before.consumed &&
      summary_.consumed <= stream_->ring.reader.written();
  if (!adds_up) {
    breach(Breach::items_lost,
           fmt::format("consumed {}, interpolated {}, passed over {}, refused {}, withdrawn {}, "
                       "controls {}",
                       summary_.consumed, summary_.interpolated(), summary_.passed_over,
                       summary_.refused, summary_.withdrawn, summary_.controls));
  }
  if (summary_.consumed - before.consumed > plan_->ring_capacity) {
    breach(Breach::unbounded_step,
           fmt::format("{} items in one step", summary_.consumed - before.consumed));
  }
  findings_->count(Event::excesses, summary_.exceeding - before.exceeding);
  for (std::size_t i = 0; i < kRefusals; ++i) {
    for (Word n = before.reasons[i]; n < summary_.reasons[i]; ++n) {
      findings_->count(static_cast<Refusal>(i));
    }
  }
}

/// `settled_until` never decreases, and each revision settles the curve up to settle_ahead after
/// the start of its step.
void RevisionCheck::check_settled_until(const Summary& before, Time now) {
  const bool had_curve = before.newest > 0;
  const bool is_back = had_curve && summary_.settled_until < before.settled_until;
  const bool is_late = summary_.revision != before.revision && summary_.newest > 0 &&
                       !summary_.finished &&
                       summary_.settled_until < now + plan_->live.settle_ahead;
  if (is_back || is_late) {
    breach(Breach::settled_back,
           fmt::format("settled until {}, before {}, step began at {}",
                       summary_.settled_until.count(), before.settled_until.count(), now.count()));
  }
}

/// Copies the segment that begins at knot `number`, or else at the knot before.
bool RevisionCheck::copy(Word number) {
  const auto& board = stream_->board.reader;
  auto taken = board_segment_.take(board, summary_, number);
  if (taken == ipc::BoardSegment::Taken::none && number > summary_.first) {
    taken = board_segment_.take(board, summary_, number - 1);
  }
  if (taken != ipc::BoardSegment::Taken::whole) return false;
  board_segment_.copy_to(copy_);
  return true;
}

void RevisionCheck::count_events(const Summary& before) {
  findings_->count(Event::starvations, summary_.underruns - before.underruns);
  findings_->count(Event::withdrawals, summary_.withdrawn - before.withdrawn);
  findings_->count(Event::waypoints_interpolated, summary_.knots - before.knots);
  findings_->count(Event::deadline_misses, summary_.deadline_misses - before.deadline_misses);
  if (!summary_.finished || before.finished) return;
  findings_->count(Event::finishes);
  if (copy_.kind == SegmentKind::entry) findings_->count(Event::returns_after_finish);
}

/// If the board has overwritten the waypoints before an entry, the solver computes the entry
/// without them. The segments do not record this, so such a curve cannot be verified.
void RevisionCheck::check_verifiable() {
  constexpr Word kLookBack = 16;
  constexpr Word kKnotsThatShape = 3;
  const bool is_short = summary_.first > 1 && summary_.run < summary_.first + kLookBack;
  if (summary_.is_later_run && summary_.run_knots <= kKnotsThatShape && is_short)
    is_verifiable_ = false;
}

/// Updates the records for the items that this revision consumed.
void RevisionCheck::take_items(const Summary& before) {
  const auto& items = items_.items();
  const bool withdraws = summary_.withdrawn > before.withdrawn;
  for (Word item = before.consumed; item < summary_.consumed; ++item) {
    const Time t = items.waypoint(item).time;
    if (items.is_taken(item, ItemKind::waypoint)) last_taken_ = item;
    if (items.is_taken(item, ItemKind::waypoint)) pending_.push_back({.item = item, .time = t});
    if (!items.is_taken(item, ItemKind::replace)) continue;
    findings_->count(Event::replacements);
    is_replaced_ = true;
    // An entry at the very start of a curve in motion normalises quaternions and removes negative
    // zeros. Neither is recorded, so such a curve cannot be verified.
    is_verifiable_ = is_verifiable_ && summary_.run > 1;
    if (t < end_) findings_->count(Event::cuts);
    std::erase_if(pending_, [t](const Pending& waypoint) { return waypoint.time >= t; });
    if (withdraws) forget_from(before.consumed);
  }
  const bool is_replaced = summary_.controls > before.controls;
  if (!withdraws || is_replaced) return check_passed(before);
  breach(Breach::items_lost, fmt::format("{} items withdrawn without a replacement",
                                         summary_.withdrawn - before.withdrawn));
}

/// Removes the pending waypoints from an item on, because each of them may have been withdrawn.
void RevisionCheck::forget_from(Word item) {
  std::erase_if(pending_, [item](const Pending& waypoint) { return waypoint.item >= item; });
}

/// Checks that the curve passes through the waypoints of this revision, from the newest back.
void RevisionCheck::check_passed(const Summary& before) {
  if (summary_.course != 0 || summary_.passed_over != before.passed_over) return;
  if (plan_->window.interpolant.method->smooths()) return;
  bool has_copy = copy(summary_.newest);
  for (auto waypoint = pending_.rbegin();
       waypoint != pending_.rend() && waypoint->item >= before.consumed; ++waypoint) {
    while (has_copy && copy_.left > waypoint->time && copy_.number > summary_.first) {
      has_copy = copy(copy_.number - 1);
    }
    const bool at_end = waypoint->time != copy_.left;
    const Waypoint sent = items_.items().waypoint(waypoint->item);
    const bool is_there = has_copy && (!at_end || waypoint->time == copy_.right);
    if (is_there && rules_.passes(copy_, at_end, sent.position, plan_->dimensions)) continue;
    breach(
        Breach::waypoint_missed,
        fmt::format("item {} at {}, segment {} from {} to {}", waypoint->item,
                    waypoint->time.count(), copy_.number, copy_.left.count(), copy_.right.count()));
    return;
  }
}

void RevisionCheck::check_settled_segments() {
  const auto segments = settled_.segments();
  for (; joined_ < segments.size(); ++joined_) {
    const ipc::SegmentCopy& segment = segments[joined_];
    if (segment.kind == SegmentKind::entry) check_entry(segment);
    if (segment.kind == SegmentKind::stop) check_stop_segment(segment);
    const Word expected = joined_ > 0 ? segments[joined_ - 1].next : 1;
    if (segment.number != expected) {
      has_gap_ = true;
      std::erase_if(pending_, [&](const Pending& p) { return p.time < segment.left; });
    } else if (joined_ > 0) {
      const auto step = rules_.step(segments[joined_ - 1], segment);
      findings_->count(Event::knots_compared);
      const auto notify = [&](Breach what, double size) {
        breach(what, fmt::format("{} times the tolerance for rounding, at {}, before segment {}",
                                 size, segment.left.count(), segment.number));
      };
      if (segments[joined_ - 1].right != segment.left) {
        notify(Breach::position_step, 0);
      }
      if (step.position > 1) notify(Breach::position_step, step.position);
      if (step.velocity > 1) notify(Breach::velocity_step, step.velocity);
    }
    check_waypoint_at(segment);
  }
  if (summary_.finished && !segments.empty()) check_last_waypoint(segments.back());
}

/// Checks that the settled curve passes through the waypoints up to the segment's left end, or that
/// they are counted as passed over.
void RevisionCheck::check_waypoint_at(const ipc::SegmentCopy& segment) {
  const bool smooths = plan_->window.interpolant.method->smooths();
  // Where the curve slows down, each segment begins at the next waypoint, after its time.
  const bool is_late = segment.kind == SegmentKind::slowed && joined_ > 0 &&
                       settled_.segments()[joined_ - 1].kind == SegmentKind::slowed;
  bool is_first = true;
  while (!pending_.empty() && pending_.front().time <= segment.left && (!is_late || is_first)) {
    const Pending waypoint = pending_.front();
    pending_.pop_front();
    is_first = false;
    const auto sent = items_.items().waypoint(waypoint.item);
    if ((is_late || waypoint.time == segment.left) &&
        (smooths || rules_.passes(segment, false, sent.position, plan_->dimensions))) {
      continue;
    }
    findings_->count(Event::waypoints_passed_over);
    last_passed_ = waypoint.item;
    // The curve may still reach the last waypoint after its time.
    if (++passed_seen_ <= summary_.passed_over + (summary_.finished ? 1 : 0)) continue;
    breach(Breach::waypoint_missed,
           fmt::format("settled item {} at {}, segment {} from {}, {} passed over", waypoint.item,
                       waypoint.time.count(), segment.number, segment.left.count(),
                       summary_.passed_over));
  }
}

/// An entry never exceeds an acceleration limit, or its own acceleration at its start if that is
/// larger.
void RevisionCheck::check_entry(const ipc::SegmentCopy& segment) {
  findings_->count(Event::entries);
  if (segment.origin.known > 0) findings_->count(Event::extrapolated_ends);
  if (segment.right < segment.natural_right) findings_->count(Event::entries_replaced);
  const auto& limits = plan_->window.limits.acceleration;
  const double length = to_seconds(segment.right - segment.left);
  for (std::size_t d = 0; d < limits.size(); ++d) {
    if (limits[d] <= 0 || plan_->dimensions[d].kind >= DimensionKind::quaternion) continue;
    const auto range =
        core::range_of(segment.order, segment.coefficients, limits.size(), d, 2, 0, length);
    const double begin = 2 * std::abs(segment.coefficients[2 * limits.size() + d]);
    const double peak = std::abs(range.largest().value);
    if (peak <= std::max(limits[d], begin) * (1 + 1e-9)) continue;
    breach(Breach::beyond_limits,
           fmt::format("entry {} from {}: {} in dimension {}, limit {}", segment.number,
                       segment.left.count(), peak, d, limits[d]));
    return;
  }
}

/// In a stop no dimension reverses or speeds up, or moves further than |v|·T/2.
void RevisionCheck::check_stop_segment(const ipc::SegmentCopy& segment) {
  findings_->count(Event::stop_segments);
  const std::size_t dimensions = plan_->dimensions.size();
  const double whole = to_seconds(segment.natural_right - segment.left);
  constexpr double kSlack = 1 + 1e-9;
  for (std::size_t d = 0; d < dimensions; ++d) {
    const double v = segment.coefficients[dimensions + d];
    const auto range = [&](int derivative) {
      return core::range_of(segment.order, segment.coefficients, dimensions, d, derivative, 0,
                            whole);
    };
    const auto velocity = range(1);
    const auto position = range(0);
    const double rounding = 1e-12 * std::abs(v);
    const bool slows = velocity.least.value >= std::min(v, 0.0) * kSlack - rounding &&
                       velocity.greatest.value <= std::max(v, 0.0) * kSlack + rounding;
    const double way = position.greatest.value - position.least.value;
    const double most = std::abs(v) * whole / 2 * kSlack + 1e-12 * std::abs(position.least.value);
    if (slows && way <= most) continue;
    breach(Breach::stop_turned,
           fmt::format("stop {} from {}: dimension {}, v {}: moves {}, limit {}, v from {} to {}",
                       segment.number, segment.left.count(), d, v, way, most, velocity.least.value,
                       velocity.greatest.value));
    return;
  }
}

void RevisionCheck::check_last_waypoint(const ipc::SegmentCopy& segment) {
  const bool smooths = plan_->window.interpolant.method->smooths();
  while (!pending_.empty()) {
    const Pending waypoint = pending_.front();
    pending_.pop_front();
    const auto sent = items_.items().waypoint(waypoint.item);
    if (waypoint.time == segment.right &&
        (smooths || rules_.passes(segment, true, sent.position, plan_->dimensions))) {
      continue;
    }
    findings_->count(Event::waypoints_passed_over);
    last_passed_ = waypoint.item;
    if (++passed_seen_ <= summary_.passed_over + 1) continue;
    breach(Breach::waypoint_missed,
           fmt::format("item {} at {} in the finished curve, {} passed over", waypoint.item,
                       waypoint.time.count(), summary_.passed_over));
  }
  const ipc::EndKind end = summary_.ending();
  const bool stops = end == ipc::EndKind::stopped || end == ipc::EndKind::in_stop;
  const bool comes_late =
      !stops && last_passed_ && last_passed_ == last_taken_ &&
      segment.kind != SegmentKind::spline &&
      (smooths || rules_.passes(segment, true, items_.items().waypoint(*last_passed_).position,
                                plan_->dimensions));
  const Word passed = passed_seen_ - (comes_late ? 1 : 0);
  if (!has_gap_ && !is_replaced_ && passed != summary_.passed_over) {
    breach(Breach::items_lost,
           fmt::format("{} waypoints passed over, {} counted", passed, summary_.passed_over));
  }
}

void RevisionCheck::check_end() {
  if (summary_.newest == 0) return;
  if (!copy(summary_.newest)) {
    return breach(Breach::no_answer, fmt::format("no segment {}", summary_.newest));
  }
  end_ = copy_.right;
  const bool is_open = !summary_.finished;
  const bool is_stop = copy_.kind == SegmentKind::stop;
  const bool halts =
      is_stop || copy_.kind != SegmentKind::spline || plan_->end.kind == ConditionKind::halt;
  const bool rests = halts || plan_->end.kind == ConditionKind::clamped;
  if ((is_open && !is_stop) || (rests && !rules_.ends_at_rest(copy_, halts))) {
    breach(Breach::not_at_rest, fmt::format("segment {}", copy_.number));
  }
}

/// A stop takes effect in the first step after it. A stop after the newest knot waits until the
/// curve reaches it or its time has come, and takes effect at most one step later.
void RevisionCheck::check_stop() {
  if (!due_stop_) return;
  const Stop stop = *due_stop_;
  const bool is_last = stream_->ring.reader.written() == stop.item + 1;
  if (!is_last || summary_.finished) return due_stop_.reset();
  // The first waypoint is taken before the stop, which takes effect one step later.
  if (summary_.newest == 0) return;
  if (!had_curve_ && summary_.consumed <= stop.item) return;
  const bool is_due = summary_.settled_until > stop.time;
  if (summary_.consumed <= stop.item && (!is_due || due_stop_->steps_due++ == 0)) return;
  const Time effect = std::max(stop.time, summary_.settled_until);
  due_stop_.reset();
  if (!copy(summary_.newest)) return;
  const auto above = std::span(copy_.coefficients)
                         .first(static_cast<std::size_t>(copy_.order) * plan_->dimensions.size())
                         .subspan(plan_->dimensions.size());
  const bool moves = std::ranges::any_of(above, [](double c) { return c != 0; });
  const bool starts_later = copy_.number == 1;  // the curve stops from the start of the motion
  if (summary_.consumed > stop.item && (!moves || starts_later)) return;
  const bool has_limits = !plan_->window.limits.acceleration.empty();
  if (copy_.left > effect || (!has_limits && copy_.right > effect + plan_->window.stop_length)) {
    breach(Breach::stop_late,
           fmt::format("item {} from {}, due at {}: the curve ends at {}", stop.item,
                       stop.time.count(), effect.count(), copy_.right.count()));
  }
}

void RevisionCheck::verify() {
  if (has_gap_ || !is_verifiable_ || settled_.segments().empty()) return;
  const auto found = ipc::verify({.window = plan_->window,
                                  .kinds = plan_->kinds,
                                  .items = items_.items(),
                                  .segments = settled_.segments(),
                                  .summary = settled_.summary(),
                                  .end = plan_->end});
  findings_->count(Event::segments_verified, found.equal);
  if (!found.first) return;
  breach(Breach::not_verified,
         fmt::format("segment {} at {}: {}: published {}, solved {}", found.first->segment,
                     found.first->left.count(), found.first->what, found.first->published,
                     found.first->solved));
}

}  // namespace splinecast::campaign
