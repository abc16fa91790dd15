#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/solve/published_curve.hpp"

/// Restores a published curve from the board.
namespace splinecast::ipc {
namespace {

using core::SegmentForm;

bool are_numbers(std::span<const double> values) noexcept {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

/// Whether a curve can continue from a knot that was read back.
bool is_sound(const core::Knot& knot) noexcept {
  const core::Prefix& prefix = knot.prefix;
  return is_time_in_range(knot.time) &&
         are_numbers(std::array{prefix.gamma, prefix.smoothing.pivot, prefix.smoothing.lower1,
                                prefix.smoothing.lower2}) &&
         are_numbers(knot.waypoint) && are_numbers(knot.g) && are_numbers(knot.position) &&
         are_numbers(knot.velocity) && are_numbers(knot.acceleration) && are_numbers(knot.residual);
}

/// Whether a summary of an unfinished stream describes a possible run.
bool describes_a_run(const Summary& summary) noexcept {
  if (summary.course >= kCourses) return false;
  if (summary.newest == 0) return summary.run_knots == 0 && !summary.is_later_run;
  const bool is_on_line = static_cast<Course>(summary.course) == Course::on_target ||
                          static_cast<Course>(summary.course) == Course::entering;
  const bool has_piece =
      !is_on_line || (summary.met < summary.run_knots &&
                      summary.run_knots - summary.met <= summary.newest - summary.run + 1);
  return summary.run >= 1 && summary.run <= summary.newest && summary.unmet <= summary.run_knots &&
         summary.met <= summary.run_knots && has_piece && summary.run_knots < Word{1} << 62U;
}

}  // namespace

void PublishedCurve::restore(const Summary& summary) noexcept {
  has_changes_ = false;
  is_entry_new_ = is_prepared_ = false;
  finish_ = Unfinished{};
  if (summary.revision == 0) shown_.begin_stream();
  changed_from_ = Time::max();
  blend_until_ = summary.blend_until;
  unmet_since_ = summary.unmet_since;
  refused_until_ = summary.refused_until;
  leaving_item_.reset();
  summary_ = summary;
  run_ = summary.run;
  run_item_ = summary.run_item;
  first_ = summary.first;
  newest_ = summary.newest;
  stop_ = summary.stop;
  rest_ = {};
  end_ = core::OnTarget{};
  met_ = unmet_ = placed_ = passed_written_ = passed_committed_ = 0;
  met_number_ = 1;
  passed_before_ = 0;
  origin_ = {};
  committed_knots_ = summary.run_knots;
  is_damaged_ = false;
  if (newest_ > 0) {
    is_damaged_ = !read_.take_last(*published_, summary_);
    rest_ = read_.right();
  }
  if (!summary.finished && !is_damaged_) restore_run();
  shown_.discarded();
  shown_.forget_after(window_.knots() > 0 ? newest_time() : origin_.time);
  keep_settled();
}

bool PublishedCurve::read_knot(Word number) noexcept {
  const bool is_there = published_->copy_knot(number, board_->revision(), knot_);
  is_damaged_ = is_damaged_ || !is_there;
  return is_there;
}

/// Converts the knot that was read last to a knot of the window. Its spans point into `values`.
/// Invalid data sets `is_damaged_`.
core::Knot PublishedCurve::restore_knot(std::span<double> values) noexcept {
  const std::size_t dimensions = window_.dimensions();
  std::size_t used = 0;
  const auto place = [&] {
    const auto part = values.subspan(used, dimensions);
    used += dimensions;
    return part;
  };
  const auto keep = [&](std::span<const double> from) {
    const auto part = place();
    std::ranges::copy(from, part.begin());
    return part.first(from.size());
  };
  const auto g = place();
  const core::Prefix prefix = published_->copy_row(knot_, g);
  const auto position = place();
  core::write_position(knot_.end(), position);
  const core::Knot knot{.time = knot_.time,
                        .prefix = prefix,
                        .newer_knots = knot_.note.newer_knots,
                        .waypoint = keep(knot_.waypoint()),
                        .g = g,
                        .position = position,
                        .velocity = keep(knot_.velocity()),
                        .acceleration = keep(knot_.acceleration()),
                        .residual = keep(knot_.residual())};
  is_damaged_ = is_damaged_ || !is_sound(knot);
  return knot;
}

/// Reads knot i of the run. Call it from the newest knot backwards. Searches both places where the
/// knot may be: the numbered slots, where it is the last waypoint at or before `line` at which a
/// segment begins, and its passed slot. A knot is in both if it was passed over first and met
/// later, or if it is one of the last met knots and its row has changed since. Then the record of
/// the later revision is used. If both are of the same revision, the passed slot is used, because a
/// cut rewrites the form of a numbered knot.
bool PublishedCurve::find_knot(std::size_t i, Word& line) noexcept {
  const Word oldest = std::max(run_, first_);
  const auto find_on_line = [&] {
    for (; line >= oldest && line > 0; --line) {
      if (!read_knot(line)) return false;
      if (knot_.note.is_waypoint && knot_.note.form != SegmentForm::none) return true;
    }
    return false;
  };
  const Word item = run_item_ << kPassedItemShift | i;
  const bool is_passed = published_->copy_passed(i, board_->revision(), knot_) &&
                         knot_.item == item && knot_.note.is_waypoint;
  const Time time = knot_.time;
  const Word revision = revision_of(knot_.tag);
  const bool is_on_line = find_on_line() && !(is_passed && knot_.time < time);
  if (is_damaged_) return false;
  if (is_on_line) --line;
  if (is_passed && (!is_on_line || revision_of(knot_.tag) <= revision)) {
    return published_->copy_passed(i, board_->revision(), knot_);
  }
  return is_on_line;
}

void PublishedCurve::restore_course() noexcept {
  end_ = end_of(static_cast<Course>(summary_.course));
  met_ = summary_.met;
  unmet_ = summary_.unmet;
  const std::size_t knots = summary_.run_knots;
  if (is_on_line()) {
    placed_ = knots;
    met_number_ = knots > 0 ? newest_ - (knots - std::min(knots, met_ + 1)) : 1;
    passed_written_ = passed_committed_ = met_;
  } else {
    met_ = placed_ = passed_written_ = passed_committed_ = knots;
    if (knots == unmet_) passed_written_ = passed_committed_ = knots - std::min(knots, kMetKept);
  }
  restore_origin();
  passed_lowest_ =
      !summary_.is_later_run && origin_.number == 1 ? 0 : unmet_ - std::min(unmet_, kMetKept);
}

/// Restores the origin: the state at which the open entry, or the stop of a run without waypoints,
/// begins.
void PublishedCurve::restore_origin() noexcept {
  if (newest_ == 0 || core::is<core::OnTarget>(end_)) return;
  Word number = newest_;
  auto* const entering = std::get_if<core::Entering>(&end_);
  if (entering != nullptr) {
    number = met_number_ - 1;
  } else {
    if (!read_knot(number)) return;
    if (knot_.note.is_waypoint) return;  // the curve ends with the stop after the newest met knot
    if (core::is<core::EnteringAhead>(end_) && !restore_beyond(number)) return;
  }
  if (entering != nullptr && number < first_) {
    // The entry is no longer on the board: it has ended.
    end_ = core::OnTarget{};
    unmet_ = met_;
    return;
  }
  if (number < run_ || !read_knot(number)) {
    is_damaged_ = true;
    return;
  }
  const core::Knot state = restore_knot(knot_values_);
  is_damaged_ = is_damaged_ || knot_.note.is_waypoint || state.acceleration.empty();
  if (is_damaged_) return;
  set_origin(number, {state.time, state.position, state.velocity, state.acceleration});
  origin_.is_new = false;
  origin_.stopped_by = knot_.begins_stoppers_stop() ? knot_.item : 0;
  origin_.is_corner = knot_.begins_at_rest();
  if (entering == nullptr || !read_knot(met_number_)) return;
  is_damaged_ = is_damaged_ || !knot_.note.arrives;
  entering->end = knot_.time;
  std::ranges::copy(knot_.acceleration(), beyond_.ref().acceleration.begin());
}

/// Restores the end of an entry beyond the newest waypoint. `number` is that of the newest knot,
/// which has been read; it is set to that of the entry's beginning.
bool PublishedCurve::restore_beyond(Word& number) noexcept {
  if (!knot_.note.arrives && (number < 2 || !read_knot(--number))) return false;
  is_damaged_ = is_damaged_ || !knot_.note.arrives || number < 2;
  auto& ahead = std::get<core::EnteringAhead>(end_);
  ahead.after = {.end = knot_.time};
  const StateRef to = beyond_.ref();
  std::ranges::copy(knot_.waypoint(), to.position.begin());
  std::ranges::copy(knot_.velocity(), to.velocity.begin());
  if (knot_.note.arrives) std::ranges::copy(knot_.acceleration(), to.acceleration.begin());
  ahead.known = std::min<Word>(knot_.item, summary_.run_knots);
  --number;
  const std::size_t last = ahead.known - 1;
  ahead.ends_at_known =
      ahead.known > unmet_ && published_->copy_passed(last, board_->revision(), knot_) &&
      knot_.item == (run_item_ << kPassedItemShift | last) && knot_.time == ahead.after.end;
  return !is_damaged_;
}

void PublishedCurve::restore_run() noexcept {
  if (!describes_a_run(summary_)) {
    is_damaged_ = true;
    return;
  }
  restore_course();
  const std::size_t size = kKnotValues * window_.dimensions();
  const std::size_t end = knots_.size();
  const std::size_t most = std::min<std::size_t>(summary_.run_knots, end);
  std::size_t count = 0;
  for (Word line = newest_; count < most && !is_damaged_; ++count) {
    const std::size_t i = summary_.run_knots - 1 - count;
    const bool is_there = find_knot(i, line);
    // Knots that the open entry does not need may no longer be on the board.
    if (!is_there && !is_damaged_ && i + kMetKept < unmet_) break;
    is_damaged_ = is_damaged_ || !is_there;
    if (is_damaged_) return;
    const std::size_t k = end - 1 - count;
    knots_[k] = restore_knot(std::span(knot_values_).subspan(size * k, size));
    is_damaged_ = is_damaged_ || (count > 0 && knots_[k].time >= knots_[k + 1].time);
  }
  if (is_damaged_) return;
  const std::size_t first = summary_.run_knots - count;
  const auto knots = std::span(knots_).last(count);
  if (!summary_.is_later_run) {
    window_.restore(first, knots);
  } else {
    window_.restore_run(first, knots);
  }
  window_.freeze_knots(summary_.run_frozen);
  passed_before_ = summary_.passed_over - std::min<Word>(summary_.passed_over, passed_over());
  const auto* const ahead = std::get_if<core::EnteringAhead>(&end_);
  const std::size_t used = ahead != nullptr ? ahead->known : unmet_;
  core::set_searching(end_, !has_given_up() && window_.knots() > used);
  restart_search();
}

}  // namespace splinecast::ipc
