#include "ipc/solve/knot_writer.hpp"

#include <algorithm>
#include <utility>

#include "ipc/layout/knot_slots.hpp"

namespace splinecast::ipc {
namespace {

using core::SegmentForm;

// If the curve has met no waypoint of a run, its window is restored from the passed slots alone.
static_assert(kPassedSlots >= core::kMaxSettle + KnotWriter::kMetKept);

}  // namespace

KnotWriter::KnotWriter(KnotBoardWriter& board, const KnotBoardReader& published,
                       const Method& method)
    : board_(&board),
      published_(&published),
      look_ahead_(std::max<std::size_t>(method.look_ahead, 1)),
      has_plain_knots_(!published.smooths() && !method.needs_acceleration()),
      values_(published.dimensions()),
      segment_(published.dimensions()) {}

void KnotWriter::restore(const core::Plan& plan, const Summary& summary, Time rest,
                         const CurveOrigin& origin) noexcept {
  const std::size_t knots = plan.window().knots();
  run_ = summary.run;
  run_item_ = summary.run_item;
  first_ = summary.first;
  newest_ = summary.newest;
  rest_ = rest;
  stop_ = summary.stop;
  origin_ = origin;
  is_entry_new_ = has_changes_ = false;
  changed_from_ = Time::max();
  committed_knots_ = summary.run_knots;
  placed_ = knots;
  met_number_ = 1;
  if (plan.is_on_target()) {
    if (knots > 0) met_number_ = newest_ - (knots - std::min(knots, plan.met() + 1));
    passed_.written = plan.met();
  } else {
    passed_.written = knots == plan.unmet() ? knots - std::min(knots, kMetKept) : knots;
  }
  passed_.committed = passed_.written;
  const bool starts_by_entry = !summary.is_later_run && plan.has_origin() && origin_.number == 1;
  passed_.lowest = starts_by_entry ? 0 : plan.unmet() - std::min(plan.unmet(), kMetKept);
  keep_settled(plan);
}

void KnotWriter::prefetch(const core::Plan& plan) const noexcept {
  if (!plan.is_on_target()) return;
  board_->prefetch(number_of(plan, std::max(first_open_, plan.met())), newest_ + 1);
}

bool KnotWriter::has_room(const core::Plan& plan, std::size_t knots, Time keep) const noexcept {
  const std::size_t known = plan.window().knots();
  const bool is_counted = has_changes_ && plan.is_on_target() && known > 0;
  return has_room_after(is_counted ? number_of(plan, known) : newest_, knots, keep);
}

bool KnotWriter::has_room_after(Word number, std::size_t knots, Time keep) const noexcept {
  if (keep == Time::max()) return true;  // a recorded stream keeps no history
  const Word newest = number + knots;
  const Word lost = newest - std::min<Word>(newest, board_->capacity());
  if (lost < std::max<Word>(first_, 1) || lost >= newest_) return true;
  return published_->time_hint(lost + 1) <= keep;  // end of the last segment that is lost
}

void KnotWriter::note_change(Time from) noexcept {
  changed_from_ = std::min(changed_from_, from);
  has_changes_ = true;
}

void KnotWriter::begun(const core::Plan& plan) noexcept {
  committed_knots_ = 0;
  left_target(plan);
  origin_ = {.number = 1, .is_new = true};
  note_change(plan.origin().time);
}

void KnotWriter::cut(const core::Plan& plan, const CurveOrigin& origin) noexcept {
  committed_knots_ = 0;
  left_target(plan);
  origin_ = origin;
  run_ = origin.number;
  run_item_ = 0;
  is_entry_new_ = false;
  kept_ = first_open_ = 0;
  note_change(plan.origin().time);
}

void KnotWriter::appended(const core::Plan& plan, Word item) noexcept {
  if (plan.window().knots() == 1) run_item_ = item + 1;
  has_changes_ = true;
  // Settled knots leave the window and are written once, with their final values.
  const std::size_t settled = plan.window().settled_knots();
  if (first_open_ >= settled) return;
  if (!plan.is_on_target()) {
    write_passed(plan, passed_.written, settled);
  } else {
    write_knots(plan, std::max(first_open_, plan.met()), settled);
  }
  first_open_ = settled;
}

void KnotWriter::left_target(const core::Plan& plan) noexcept {
  origin_ = {};
  placed_ = plan.window().knots();
  // The next waypoint changes the rows of the last met knots, and many entries in sequence may push
  // these knots off the board. So write_passed() writes them to the passed slots.
  passed_.lowest = plan.unmet() - std::min(plan.unmet(), kMetKept);
  passed_.written = passed_.committed = passed_.lowest;
}

void KnotWriter::rests_at_start(const core::Plan& plan) noexcept {
  placed_ = plan.window().knots();
  passed_ = {};
  origin_ = {.number = 1, .is_new = true};
  note_change(plan.origin().time);
}

void KnotWriter::starts_on_target(const core::Plan& plan) noexcept {
  placed_ = kept_ = first_open_ = 0;
  met_number_ = 1;
  origin_ = {};
  note_change(plan.window().time(0));
}

void KnotWriter::entered(const core::Plan& plan, std::optional<Word> origin) noexcept {
  if (origin) {
    origin_ = {.number = *origin, .is_new = true};
    // The cut rewrites the newest met knot, but not its row. So the row must be in the passed
    // slots: see PlanReader.
    passed_.written = passed_.lowest;
  }
  is_entry_new_ = true;
  placed_ = plan.met();
  if (plan.is_on_target()) {
    met_number_ = origin_.number + 1;
    kept_ = first_open_ = placed_;
  }
  note_change(plan.origin().time);
}

void KnotWriter::ended_by_entry(const core::Plan& plan, std::optional<Word> origin) noexcept {
  if (origin) origin_ = {.number = *origin, .is_new = true};
  is_entry_new_ = true;
  note_change(plan.origin().time);
}

void KnotWriter::ended_on_target(const core::Plan& plan) noexcept {
  has_changes_ = true;
  // A full stop changes the form of the last segment: its left knot is written again.
  const std::size_t knots = plan.window().knots();
  first_open_ = std::min(first_open_, knots - std::min<std::size_t>(knots, 2));
}

void KnotWriter::ended_in_stop(const core::Plan& plan) noexcept {
  has_changes_ = true;
  first_open_ = std::min(first_open_, plan.window().knots() - 1);
}

void KnotWriter::keep_settled(const core::Plan& plan) noexcept {
  kept_ = plan.window().settled_knots();
  // The next knot changes the segment that begins at the newest one.
  first_open_ = std::min(kept_, std::max<std::size_t>(placed_, 1) - 1);
}

/// Removes from the range of knots the oldest ones, which the newest ones have overwritten.
void KnotWriter::drop_oldest() noexcept {
  // A replacement may lower newest_, but overwritten knots stay lost: first_ never decreases.
  const Word kept = newest_ - std::min<Word>(newest_, board_->capacity()) + 1;
  if (kept <= first_) return;
  first_ = kept;
  // A segment must begin at first_. A knot without one is only the right end of a lost segment.
  if (first_ < newest_ && board_->form(first_) == SegmentForm::none) ++first_;
}

std::optional<Time> KnotWriter::write(const core::Plan& plan, SlowedEnd& slowed) noexcept {
  bool is_whole = true;
  if (has_changes_ && (plan.window().knots() > 0 || plan.window().is_later_run())) {
    const bool writes_origin = plan.has_origin() && (origin_.is_new || is_entry_new_);
    if (writes_origin) write_origin(plan);
    if (plan.ending() == EndKind::entered) {
      write_ending(plan);
    } else if (plan.ending() == EndKind::slowed) {
      is_whole = slowed.write(*board_);
      stop_ = Time::zero();
      rest_ = plan.ended()->rest;
    } else if (plan.is_on_target()) {
      write_on_target(plan);
    } else {
      write_off_target(plan, writes_origin);
    }
    drop_oldest();
  }
  const Time from = std::exchange(changed_from_, Time::max());
  return is_whole ? std::optional(from) : std::nullopt;
}

void KnotWriter::write_summary(const core::Plan& plan, Summary& out) const noexcept {
  const core::SlidingWindow& window = plan.window();
  out.first = first_;
  out.newest = newest_;
  out.stop = stop_;
  out.run = run_;
  out.run_knots = window.knots();
  out.run_item = run_item_;
  out.run_frozen = window.frozen_knots();
  out.is_later_run = window.is_later_run();
  out.course = static_cast<Word>(course_of(plan.end()));
  out.met = plan.met();
  out.unmet = plan.unmet();
  out.blend_until = plan.blend_until();
  out.passed_over = plan.passed_over();
  out.unmet_since = plan.unmet_since();
  out.refused_until = plan.refused_until();
}

void KnotWriter::committed(const core::Plan& plan) noexcept {
  has_changes_ = is_entry_new_ = false;
  origin_.is_new = false;
  passed_.committed = passed_.written;
  committed_knots_ = plan.window().knots();
  if (plan.is_on_target()) placed_ = committed_knots_;
  keep_settled(plan);
}

}  // namespace splinecast::ipc
