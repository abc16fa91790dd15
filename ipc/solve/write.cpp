#include <algorithm>
#include <array>
#include <utility>

#include "core/forms/stop.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/solve/published_curve.hpp"

/// Writes a published curve as knots on the board.
namespace splinecast::ipc {
namespace {

using core::SegmentForm;

constexpr std::array<double, kMaxDimensions> kZeros{};

/// While a run has at most this many knots, an append may change the rows of all of them.
constexpr std::size_t kFirstKnots = 4;

/// Whether the curve of an origin is only the stop from there.
bool only_stops(const core::End& end) noexcept {
  return core::is<core::Waiting>(end) || core::is<core::Starting>(end);
}

}  // namespace

/// Writes the knot of the origin: an entry begins there or, in a run without an entry, a stop.
void PublishedCurve::write_origin() noexcept {
  const bool enters = !only_stops(end_) || ending() == EndKind::entered;
  const auto zeros = std::span(kZeros).first(published_->smooths() ? window_.dimensions() : 0);
  std::ranges::copy(origin_state_.acceleration(), values_.begin());
  if (!enters) core::align_rotations(window_.kinds(), origin_state_.velocity(), values_);
  const bool is_stopped = !enters && origin_.stopped_by > 0;
  const std::size_t known = core::is<core::Entering>(end_) ? search_.end().known - 1 - met_ : 0;
  board_->write(origin_.number, {.is_new = true,
                                 .note = {.form = enters ? SegmentForm::entry : SegmentForm::stop,
                                          .starts = true,
                                          .newer_knots = static_cast<std::uint32_t>(known),
                                          .is_corner = origin_.is_corner || is_stopped},
                                 .time = origin_.time,
                                 .position = origin_state_.position(),
                                 .velocity = origin_state_.velocity(),
                                 .acceleration = values_,
                                 .residual = zeros,
                                 .item = enters ? run_item_ : origin_.stopped_by});
  note_change(origin_.time);
}

/// Writes the end of an entry beyond the newest waypoint, and the motion after it: the remainder of
/// the straight line and the stop, or the remainder of the stop.
void PublishedCurve::write_beyond(const core::EnteringAhead& ahead) noexcept {
  const auto zeros = std::span(kZeros).first(window_.dimensions());
  const auto residual = zeros.first(published_->smooths() ? window_.dimensions() : 0);
  const core::AfterEntry& after = ahead.after;
  const bool has_line = after.has_line();
  KnotRecord record{.is_new = true,
                    .note = {.form = has_line ? SegmentForm::cubic : SegmentForm::stop,
                             .arrives = true,
                             .starts = !has_line},
                    .time = after.end,
                    .begins = after.end,
                    .position = beyond_.position(),
                    .velocity = beyond_.velocity(),
                    .acceleration = beyond_.acceleration(),
                    .residual = residual,
                    .item = ahead.known};
  board_->write(origin_.number + 1, record);
  newest_ = origin_.number + 1;
  if (has_line) {
    after.write_line_end(beyond_.position(), beyond_.velocity(), values_);
    record.note = {.form = SegmentForm::stop, .starts = true};
    record.time = record.begins = after.line_end;
    record.position = values_;
    record.acceleration = zeros;
    record.item = 0;
    board_->write(++newest_, record);
  }
  stop_ = after.stop_length();
  if (stop_ > after.rest - after.stop_begin()) {
    // The motion at the end of the former stop may need longer.
    stop_ = std::max(stop_, core::least_stop_time(window_.limits_at_largest_rate(), kinds_,
                                                  {after.end, beyond_.position(),
                                                   beyond_.velocity(), beyond_.acceleration()}));
  }
  rest_ = after.stop_begin() + stop_;
}

/// Writes the end of an entry that ends the curve.
void PublishedCurve::write_ending() noexcept {
  const auto zeros = std::span(kZeros).first(window_.dimensions());
  newest_ = origin_.number + 1;
  stop_ = Time::zero();
  rest_ = std::get<Ended>(finish_).rest;
  board_->write(newest_, {.is_new = true,
                          .note = {.arrives = true},
                          .time = rest_,
                          .begins = rest_,
                          .position = beyond_.position(),
                          .velocity = zeros,
                          .acceleration = zeros,
                          .residual = zeros.first(published_->smooths() ? zeros.size() : 0)});
}

/// Adds the row of knot i to its record if an append may have changed it: an append changes the
/// last look_ahead_ rows, and all rows of a run of up to kFirstKnots.
void PublishedCurve::give_row(std::size_t i, const core::Knot& knot,
                              KnotRecord& record) const noexcept {
  const std::size_t known = committed_knots_;
  const std::size_t first_row = known <= kFirstKnots ? 0 : known - std::min(known, look_ahead_);
  if (!record.is_new && i < first_row) return;
  record.prefix = &knot.prefix;
  record.g = knot.g;
}

/// Writes knots `first` to `end` - 1 of the run to the passed slots, for a solver that takes over:
/// waypoints that the curve passes over, and the last met ones, because the next waypoint changes
/// their rows.
void PublishedCurve::write_passed(std::size_t first, std::size_t end) noexcept {
  const auto zeros = std::span(kZeros).first(window_.dimensions());
  for (std::size_t i = first; i < end; ++i) {
    const core::Knot knot = window_.knot(i);
    KnotRecord record{
        .is_new = i >= passed_committed_,
        .note = {.is_waypoint = true, .arrives = true, .newer_knots = knot.newer_knots},
        .time = knot.time,
        .position = knot.waypoint,
        .velocity = knot.velocity,
        .acceleration = knot.acceleration.empty() ? zeros : knot.acceleration,
        .residual = knot.residual,
        .item = run_item_ << kPassedItemShift | i};
    give_row(i, knot, record);
    board_->write_passed(i, record);
  }
  passed_written_ = std::max(passed_written_, end);
}

/// Writes to the passed slots all knots before `end` that may have changed since the commit, or
/// whose rows may have.
void PublishedCurve::write_unmet(std::size_t end) noexcept {
  const std::size_t knots = window_.knots();
  const std::size_t solved = knots - std::min(knots, window_.options().settle);
  const std::size_t changed = std::min(solved, committed_knots_);
  const std::size_t first = std::min(changed - std::min(changed, look_ahead_), passed_written_);
  write_passed(std::max({first, window_.first_to_restore(), passed_lowest_}), end);
}

/// Appends since the commit have changed at most the velocities of the knots before this one. 0 if
/// they may have changed more.
std::size_t PublishedCurve::plain_knots() const noexcept {
  const bool is_plain = has_plain_knots_ && !window_.finished() && committed_knots_ > kFirstKnots &&
                        placed_ == committed_knots_;
  return is_plain ? placed_ - look_ahead_ : 0;
}

/// Writes knots `first` to `end` - 1 of the run as the window has them now.
void PublishedCurve::write_knots(std::size_t first, std::size_t end) noexcept {
  const std::size_t plain_end = std::min(plain_knots(), end);
  // Other values of the first knot of the piece of the target may have changed too.
  const std::size_t plain_first = std::max<std::size_t>(kept_, met_ + 1);
  std::size_t i = first;
  for (; i < std::min(plain_first, end); ++i) write_knot(i);
  if (i < plain_end) note_change(window_.time(i - 1));
  while (i < plain_end) {
    const auto velocities = window_.velocities(i, plain_end - i);
    board_->write_velocities(number_of(i), window_.newer_knots_seen(i), velocities);
    i += velocities.count;
  }
  for (; i < end; ++i) write_knot(i);
}

/// Writes knot i of the run as the window has it now.
void PublishedCurve::write_knot(std::size_t i) noexcept {
  const core::Knot knot = window_.knot(i);
  const bool is_newest = i + 1 == window_.knots();
  const bool ends_entry = i == met_ && core::is<core::Entering>(end_);
  KnotRecord record{.is_new = i >= placed_,
                    .note = {.form = window_.form(i),
                             .is_waypoint = true,
                             .arrives = ends_entry || !knot.acceleration.empty(),
                             .starts = !knot.acceleration.empty(),
                             .newer_knots = knot.newer_knots},
                    .time = knot.time,
                    .begins = knot.time,
                    .position = knot.waypoint,
                    .velocity = knot.velocity,
                    .acceleration = ends_entry ? beyond_.acceleration() : knot.acceleration,
                    .residual = knot.residual};
  if (record.note.form == SegmentForm::stop) {
    // A knot stores one acceleration: if a segment arrives with a given one, the stop starts with
    // it.
    if (ending() == EndKind::stopped) {
      stop_behind_newest(segment_);
      stop_ = segment_.right - segment_.left;
    } else if (ends_entry) {
      stop_ = window_.stop_time(record.acceleration);
    } else {
      stop_ = window_.write_stop(values_);
    }
    rest_ = knot.time + stop_;
    record.note.starts = true;
    if (!ends_entry) record.acceleration = values_;
  }
  give_row(i, knot, record);
  board_->write(number_of(i), record);
  const bool was_stop = i + 1 == placed_ && !is_newest;
  if (i >= kept_) {
    note_change(i > met_ ? window_.time(i - 1) : knot.time);
  } else if (was_stop || window_.finished()) {
    note_change(knot.time);
  }
}

/// Writes the changes of a curve that does not end on the target, and the stop at its end.
void PublishedCurve::write_off_line(bool writes_origin) noexcept {
  const auto* const ahead = std::get_if<core::EnteringAhead>(&end_);
  if (is_entry_new_ && ahead != nullptr) write_beyond(*ahead);
  if (writes_origin && only_stops(end_)) {
    newest_ = origin_.number;
    stop_ = core::build_stop_within(window_.stop_rules(), origin_state(), segment_);
    rest_ = origin_.time + stop_;
  }
  if (window_.knots() > 0) write_unmet(window_.knots());
}

/// Writes the changes of a curve that ends with a piece of the target.
void PublishedCurve::write_on_line() noexcept {
  const std::size_t knots = window_.knots();
  if (is_entry_new_) write_unmet(met_);
  write_knots(std::max(open_, met_), knots);
  newest_ = number_of(knots - 1);
  if (!window_.finished()) return;
  stop_ = Time::zero();
  rest_ = window_.time(knots - 1);
}

/// Removes from the range of knots the oldest ones, which the newest ones have overwritten.
void PublishedCurve::drop_oldest() noexcept {
  // A replacement may lower newest_, but overwritten knots stay lost: first_ never decreases.
  const Word kept = newest_ - std::min<Word>(newest_, board_->capacity()) + 1;
  if (kept <= first_) return;
  first_ = kept;
  // A segment must begin at first_. A knot without one is only the right end of a lost segment.
  if (first_ < newest_ && board_->form(first_) == SegmentForm::none) ++first_;
}

Time PublishedCurve::write() noexcept {
  if (has_changes_ && (window_.knots() > 0 || window_.is_later_run())) {
    const bool writes_origin = origin_.number > 0 && (origin_.is_new || is_entry_new_);
    if (writes_origin) write_origin();
    if (ending() == EndKind::entered) {
      write_ending();
    } else if (ending() == EndKind::slowed) {
      is_damaged_ = !slowed_.write(*board_) || is_damaged_;
      stop_ = Time::zero();
      rest_ = slowed_.end();
    } else if (is_on_line()) {
      write_on_line();
    } else {
      write_off_line(writes_origin);
    }
    drop_oldest();
  }
  return std::exchange(changed_from_, Time::max());
}

CurveSummary PublishedCurve::summary() const noexcept {
  const auto* const ahead = std::get_if<core::EnteringAhead>(&end_);
  return {.first = first_,
          .newest = newest_,
          .stop = stop_,
          .run = run_,
          .run_knots = window_.knots(),
          .run_item = run_item_,
          .run_frozen = window_.frozen_knots(),
          .is_later_run = window_.is_later_run(),
          .course = course(),
          .met = met_,
          .unmet = unmet_,
          .goal = ahead != nullptr && ahead->ends_at_known ? ahead->known : 0,
          .blend_until = blend_until_,
          .passed_over = passed_before_ + passed_over(),
          .unmet_since = unmet_since_,
          .refused_until = refused_until_};
}

core::End end_of(Course course) noexcept {
  switch (course) {
    case Course::on_target:
      break;
    case Course::waiting:
      return core::Waiting{};
    case Course::entering:
      return core::Entering{};
    case Course::beyond:
      return core::EnteringAhead{};
    case Course::starting:
      return core::Starting{};
  }
  return core::OnTarget{};
}

void put_summary(const CurveSummary& curve, Summary& summary) noexcept {
  summary.first = curve.first;
  summary.newest = curve.newest;
  summary.stop = curve.stop;
  summary.run = curve.run;
  summary.run_knots = curve.run_knots;
  summary.run_item = curve.run_item;
  summary.run_frozen = curve.run_frozen;
  summary.is_later_run = curve.is_later_run;
  summary.course = static_cast<Word>(curve.course);
  summary.met = curve.met;
  summary.unmet = curve.unmet;
  summary.blend_until = curve.blend_until;
  summary.passed_over = curve.passed_over;
  summary.unmet_since = curve.unmet_since;
  summary.refused_until = curve.refused_until;
}

}  // namespace splinecast::ipc
