#include "ipc/runs/slowed_end.hpp"

#include <algorithm>
#include <utility>

#include "core/forms/knot_segment.hpp"
#include "core/limits/check.hpp"
#include "core/motion/slowed_path.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

SlowedEnd::SlowedEnd(const KnotBoardReader& published, DimensionKinds kinds)
    : published_(&published),
      kinds_(std::move(kinds)),
      range_(published.dimensions()),
      path_(published.dimensions(), published.smooths()),
      knots_{Knot(published), Knot(published)},
      piece_(published.dimensions()),
      before_(published.dimensions()),
      after_(published.dimensions()) {}

void SlowedEnd::restart(const Summary& summary, const MotionLimits& limits) noexcept {
  summary_ = summary;
  limits_ = &limits;
  first_ = summary.newest - 1;
  passed_ = 0;
  is_damaged_ = false;
}

SlowedEnd::Outcome SlowedEnd::search(Word oldest, Time settled, int& tries) noexcept {
  for (; first_ >= oldest; --first_, passed_ = 0) {
    if (published_->time_hint(first_) < settled) break;
    if (passed_ == 0 && !begin_at(first_)) {
      if (is_damaged_) return Outcome::damaged;
      continue;
    }
    // The rate falls fastest where half of its time, and this part of the way, has passed.
    const Word pieces = summary_.newest - first_;
    const Word steepest = pieces * 13 / 16;
    for (; passed_ < pieces; ++passed_) {
      if (tries <= 0) return Outcome::more;
      --tries;
      const Word number = first_ + (steepest + passed_) % pieces;
      if (!build_piece(number) || !passes(number)) break;
    }
    if (is_damaged_) return Outcome::damaged;
    if (passed_ == pieces) return Outcome::found;
  }
  return Outcome::none;
}

/// Tries a knot to slow down from. Returns false if it cannot be.
bool SlowedEnd::begin_at(Word number) noexcept {
  KnotCopy& begin = knots_[0].path;
  KnotCopy& end = knots_[1].path;
  const Word r = summary_.revision;
  is_damaged_ = !published_->copy_knot(number, r, begin) ||
                !published_->copy_knot(summary_.newest, r, end) || !is_time_in_range(begin.time) ||
                !is_time_in_range(end.time) || begin.time >= end.time;
  if (is_damaged_ || !read_path(number)) return false;
  if (number + 1 == summary_.newest) {
    range_.restart(path_.coefficients().first(before_.size()));
  }
  range_.add(path_part());
  slowing_ = core::Slowing(begin.time, end.time);
  return is_time_in_range(slowing_.end_time());
}

/// Reads the segment of the path that begins at a knot.
bool SlowedEnd::read_path(Word number) noexcept {
  const bool is_there = path_.take(*published_, summary_, number) == BoardSegment::Taken::whole &&
                        path_.right() == path_.natural_right();
  is_damaged_ = is_damaged_ || !is_there;
  return is_there;
}

/// Slows a knot down.
bool SlowedEnd::slow(Word number, Knot& out) noexcept {
  is_damaged_ = is_damaged_ || !published_->copy_knot(number, summary_.revision, out.path);
  if (is_damaged_) return false;
  out.time = slowing_.time_of(out.path.time);
  if (!read_path(number - 1)) return false;
  core::evaluate_derivative(path_.order(), path_.coefficients(),
                            to_seconds(path_.right() - path_.left()), 2, before_);
  if (number == summary_.newest) {
    std::ranges::copy(before_, after_.begin());
  } else if (!read_path(number)) {
    return false;
  } else {
    core::evaluate_derivative(path_.order(), path_.coefficients(), 0, 2, after_);
  }
  slowing_.write_state(out.time, out.path.velocity(), before_, after_, out.velocity,
                       out.acceleration);
  // A segment before the first knot may end with the acceleration that the knot has.
  if (number == first_ && out.path.note.arrives) {
    std::ranges::copy(out.path.acceleration(), out.acceleration.begin());
  }
  return true;
}

/// Builds the piece after a knot. Returns false if it would not end after its begin.
bool SlowedEnd::build_piece(Word number) noexcept {
  if (!slow(number, knots_[0]) || !slow(number + 1, knots_[1])) return false;
  if (knots_[0].time >= knots_[1].time) return false;
  core::build_segment(core::SegmentForm::slowed, knots_[0].end(), knots_[1].end(), piece_);
  return true;
}

core::SegmentPart SlowedEnd::path_part() const noexcept {
  return {.order = path_.order(),
          .coefficients = path_.coefficients(),
          .dimensions = before_.size(),
          .from = 0,
          .to = to_seconds(path_.right() - path_.left())};
}

/// Whether the piece after a knot is as good as the path.
bool SlowedEnd::passes(Word number) noexcept {
  return core::keeps_length(kinds_, piece_) && read_path(number) &&
         core::stays_near(slowing_, piece_, path_part(), path_.left(), range_) &&
         core::exceeds_no_more(*limits_, &kinds_, core::part_of(piece_), path_part());
}

bool SlowedEnd::write(KnotBoardWriter& board) noexcept {
  for (Word number = first_; number <= summary_.newest; ++number) {
    if (!slow(number, knots_[0])) return false;
    const Knot& knot = knots_[0];
    const bool is_last = number == summary_.newest;
    KnotNote note = knot.path.note;
    note.form = is_last ? core::SegmentForm::none : core::SegmentForm::slowed;
    note.arrives = note.arrives || number > first_;
    note.starts = !is_last;
    board.write(number, {.is_new = true,
                         .note = note,
                         .time = knot.time,
                         .begins = knot.time,
                         .position = knot.path.waypoint(),
                         .velocity = knot.velocity,
                         .acceleration = knot.acceleration,
                         .residual = knot.path.residual()});
  }
  return true;
}

}  // namespace splinecast::ipc
