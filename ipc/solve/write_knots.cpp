#include <algorithm>
#include <array>

#include "core/forms/stop.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/solve/knot_writer.hpp"

/// The knots of a plan as records of the board.
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
void KnotWriter::write_origin(const core::Plan& plan) noexcept {
  const bool enters = !only_stops(plan.end()) || plan.ending() == EndKind::entered;
  const auto zeros = std::span(kZeros).first(published_->smooths() ? values_.size() : 0);
  const Instant origin = plan.origin();
  std::ranges::copy(origin.acceleration, values_.begin());
  if (!enters) core::align_rotations(plan.window().kinds(), origin.velocity, values_);
  const bool is_stopped = !enters && origin_.stopped_by > 0;
  const auto* const entering = std::get_if<core::Entering>(&plan.end());
  const bool ends_at_knot = entering != nullptr && plan.ending() != EndKind::entered;
  const std::size_t newer = ends_at_knot ? entering->known - 1 - plan.met() : 0;
  board_->write(origin_.number, {.is_new = true,
                                 .note = {.form = enters ? SegmentForm::entry : SegmentForm::stop,
                                          .starts = true,
                                          .newer_knots = static_cast<std::uint32_t>(newer),
                                          .is_corner = origin_.is_corner || is_stopped},
                                 .time = origin.time,
                                 .position = origin.position,
                                 .velocity = origin.velocity,
                                 .acceleration = values_,
                                 .residual = zeros,
                                 .item = enters ? run_item_ : origin_.stopped_by});
  note_change(origin.time);
}

/// Writes the end of an entry ahead of the newest waypoint, and the motion after it: the remainder
/// of the straight line and the stop, or the remainder of the stop.
void KnotWriter::write_ahead(const core::Plan& plan, const core::EnteringAhead& ahead) noexcept {
  const auto zeros = std::span(kZeros).first(values_.size());
  const auto residual = zeros.first(published_->smooths() ? zeros.size() : 0);
  const core::AfterEntry& after = ahead.after;
  const State& end = plan.entry_end();
  const bool has_line = after.has_line();
  KnotRecord record{.is_new = true,
                    .note = {.form = has_line ? SegmentForm::cubic : SegmentForm::stop,
                             .arrives = true,
                             .starts = !has_line},
                    .time = after.end,
                    .begins = after.end,
                    .position = end.position(),
                    .velocity = end.velocity(),
                    .acceleration = end.acceleration(),
                    .residual = residual,
                    .item = ahead.known};
  board_->write(origin_.number + 1, record);
  newest_ = origin_.number + 1;
  if (has_line) {
    const Instant stop = plan.stop_begin(ahead, values_);
    record.note = {.form = SegmentForm::stop, .starts = true};
    record.time = record.begins = stop.time;
    record.position = stop.position;
    record.acceleration = stop.acceleration;
    record.item = 0;
    board_->write(++newest_, record);
  }
  stop_ = plan.stop_after_entry(ahead);
  rest_ = after.stop_begin() + stop_;
}

/// Writes the end of an entry that ends the curve.
void KnotWriter::write_ending(const core::Plan& plan) noexcept {
  const auto zeros = std::span(kZeros).first(values_.size());
  newest_ = origin_.number + 1;
  stop_ = Time::zero();
  rest_ = plan.ended()->rest;
  board_->write(newest_, {.is_new = true,
                          .note = {.arrives = true},
                          .time = rest_,
                          .begins = rest_,
                          .position = plan.entry_end().position(),
                          .velocity = zeros,
                          .acceleration = zeros,
                          .residual = zeros.first(published_->smooths() ? zeros.size() : 0)});
}

/// Adds the row of knot i to its record if an append may have changed it: an append changes the
/// last look_ahead_ rows, and all rows of a run of up to kFirstKnots.
void KnotWriter::give_row(std::size_t i, const core::Knot& knot,
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
void KnotWriter::write_passed(const core::Plan& plan, std::size_t first, std::size_t end) noexcept {
  const auto zeros = std::span(kZeros).first(values_.size());
  for (std::size_t i = first; i < end; ++i) {
    const core::Knot knot = plan.window().knot(i);
    KnotRecord record{
        .is_new = i >= passed_.committed,
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
  passed_.written = std::max(passed_.written, end);
}

/// Writes to the passed slots all knots before `end` that may have changed since the commit, or
/// whose rows may have.
void KnotWriter::write_unmet(const core::Plan& plan, std::size_t end) noexcept {
  const core::SlidingWindow& window = plan.window();
  const std::size_t knots = window.knots();
  const std::size_t solved = knots - std::min(knots, window.options().settle);
  const std::size_t changed = std::min(solved, committed_knots_);
  const std::size_t first = std::min(changed - std::min(changed, look_ahead_), passed_.written);
  write_passed(plan, std::max({first, window.first_to_restore(), passed_.lowest}), end);
}

/// Appends since the commit have changed at most the velocities of the knots before this one. 0 if
/// they may have changed more.
std::size_t KnotWriter::plain_knots(const core::Plan& plan) const noexcept {
  const bool is_plain = has_plain_knots_ && !plan.window().finished() &&
                        committed_knots_ > kFirstKnots && placed_ == committed_knots_;
  return is_plain ? placed_ - look_ahead_ : 0;
}

/// Writes knots `first` to `end` - 1 of the run as the window has them now.
void KnotWriter::write_knots(const core::Plan& plan, std::size_t first, std::size_t end) noexcept {
  const core::SlidingWindow& window = plan.window();
  const std::size_t plain_end = std::min(plain_knots(plan), end);
  // Other values of the first knot of the piece of the target may have changed too.
  const std::size_t plain_first = std::max<std::size_t>(kept_, plan.met() + 1);
  std::size_t i = first;
  for (; i < std::min(plain_first, end); ++i) write_knot(plan, i);
  if (i < plain_end) note_change(window.time(i - 1));
  while (i < plain_end) {
    const auto velocities = window.velocities(i, plain_end - i);
    board_->write_velocities(number_of(plan, i), window.newer_knots_seen(i), velocities);
    i += velocities.count;
  }
  for (; i < end; ++i) write_knot(plan, i);
}

/// Writes knot i of the run as the window has it now.
void KnotWriter::write_knot(const core::Plan& plan, std::size_t i) noexcept {
  const core::SlidingWindow& window = plan.window();
  const core::Knot knot = window.knot(i);
  const bool is_newest = i + 1 == window.knots();
  const bool ends_entry = i == plan.met() && core::is<core::Entering>(plan.end());
  KnotRecord record{
      .is_new = i >= placed_,
      .note = {.form = window.form(i),
               .is_waypoint = true,
               .arrives = ends_entry || !knot.acceleration.empty(),
               .starts = !knot.acceleration.empty(),
               .newer_knots = knot.newer_knots},
      .time = knot.time,
      .begins = knot.time,
      .position = knot.waypoint,
      .velocity = knot.velocity,
      .acceleration = ends_entry ? plan.entry_end().acceleration() : knot.acceleration,
      .residual = knot.residual};
  if (record.note.form == SegmentForm::stop) write_stop(plan, ends_entry, record);
  give_row(i, knot, record);
  board_->write(number_of(plan, i), record);
  const bool was_stop = i + 1 == placed_ && !is_newest;
  if (i >= kept_) {
    note_change(i > plan.met() ? window.time(i - 1) : knot.time);
  } else if (was_stop || window.finished()) {
    note_change(knot.time);
  }
}

/// Adds the stop after the newest knot to its record, whose acceleration refers to values_ then.
void KnotWriter::write_stop(const core::Plan& plan, bool ends_entry, KnotRecord& record) noexcept {
  // A knot stores one acceleration: if a segment arrives with a given one, the stop starts with it.
  if (plan.ending() == EndKind::stopped) {
    (void)plan.window().write_stop(values_);
    stop_ = plan.ended()->rest - record.time;
  } else if (ends_entry) {
    stop_ = plan.window().stop_length(record.acceleration);
  } else {
    stop_ = plan.window().write_stop(values_);
  }
  rest_ = record.time + stop_;
  record.note.starts = true;
  if (!ends_entry) record.acceleration = values_;
}

/// Writes the changes of a curve that does not end on the target, and the stop at its end.
void KnotWriter::write_off_target(const core::Plan& plan, bool writes_origin) noexcept {
  const auto* const ahead = std::get_if<core::EnteringAhead>(&plan.end());
  if (is_entry_new_ && ahead != nullptr) write_ahead(plan, *ahead);
  if (writes_origin && only_stops(plan.end())) {
    newest_ = origin_.number;
    stop_ = core::build_stop_within(plan.window().stop_rules(), plan.origin(), segment_);
    rest_ = plan.origin().time + stop_;
  }
  const std::size_t knots = plan.window().knots();
  if (knots > 0) write_unmet(plan, knots);
}

/// Writes the changes of a curve that ends with a piece of the target.
void KnotWriter::write_on_target(const core::Plan& plan) noexcept {
  const std::size_t knots = plan.window().knots();
  if (is_entry_new_) write_unmet(plan, plan.met());
  write_knots(plan, std::max(first_open_, plan.met()), knots);
  newest_ = number_of(plan, knots - 1);
  if (!plan.window().finished()) return;
  stop_ = Time::zero();
  rest_ = plan.newest_time();
}

}  // namespace splinecast::ipc
