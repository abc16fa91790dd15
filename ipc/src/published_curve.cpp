#include "splinecast/ipc/published_curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "splinecast/ipc/waypoint_ring.hpp"

namespace splinecast::ipc {
namespace {

using core::SegmentForm;

constexpr std::array<double, core::kMaxDimensions> kZeros{};

/// Values of a knot that a window is restored from: waypoint, g, position, velocity, acceleration
/// and residual of D each.
constexpr std::size_t kKnotValues = 6;

/// Knots of a run whose rows an append may change however far back its method looks.
constexpr std::size_t kFirstKnots = 4;

bool are_numbers(std::span<const double> values) noexcept {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

/// Whether a knot that was read back can be gone on from.
bool is_sound(const core::Knot& knot) noexcept {
  const core::Prefix& prefix = knot.prefix;
  return is_time_in_range(knot.time) &&
         are_numbers(std::array{prefix.gamma, prefix.smoothing.pivot, prefix.smoothing.lower1,
                                prefix.smoothing.lower2}) &&
         are_numbers(knot.waypoint) && are_numbers(knot.g) && are_numbers(knot.position) &&
         are_numbers(knot.velocity) && are_numbers(knot.acceleration) && are_numbers(knot.residual);
}

}  // namespace

PublishedCurve::PublishedCurve(KnotBoardWriter& board, const KnotBoardReader& published,
                               const core::WindowOptions& options, core::DimensionKinds kinds)
    : board_(&board),
      published_(&published),
      window_(published.dimensions(), options),
      kinds_(std::move(kinds)),
      look_ahead_(std::max<std::size_t>(options.interpolant.method->look_ahead, 1)),
      has_plain_knots_(!published.smooths() && !options.interpolant.method->needs_acceleration()),
      segment_(published.dimensions()),
      read_(published.dimensions(), published.smooths()),
      knot_(published.dimensions(), published.smooths()),
      state_(published.dimensions()),
      knot_values_(kKnotValues * published.dimensions() * window_.knots_to_restore()),
      entry_values_(kKnotValues * published.dimensions()),
      standing_values_(published.dimensions() * standing_.size()) {
  knots_.reserve(window_.knots_to_restore());
  if (!options.limits.acceleration.empty()) trial_.emplace(published.dimensions(), options);
}

void PublishedCurve::prefetch() const noexcept {
  window_.prefetch();
  board_->prefetch(number_of(open_), newest_ + 1);
}

core::Time PublishedCurve::newest_time() const noexcept {
  if (window_.knots() > 0) return window_.knot(window_.knots() - 1).time;
  return window_.entry().time();
}

core::Time PublishedCurve::settled_until() const noexcept {
  const std::size_t knots = window_.knots();
  if (knots == 0) return window_.entry().time();
  const std::size_t open = window_.settled_segments();
  if (window_.is_entered() && open == 0) return window_.entry().time();
  const std::size_t first = window_.is_entered() ? open - 1 : open;
  return window_.knot(std::min(first, knots - 1)).time;
}

std::span<const double> PublishedCurve::newest_position() const noexcept {
  if (window_.knots() > 0) return window_.knot(window_.knots() - 1).waypoint;
  return window_.is_entered() ? window_.entry().state().position : std::span<const double>{};
}

void PublishedCurve::freeze(core::Time t) noexcept {
  window_.freeze(t);
  keep_settled();
}

/// Before anything is changed: all knots are on the board as they are, settled ones for good.
void PublishedCurve::keep_settled() noexcept {
  kept_ = window_.settled_knots();
  // At the newest knot another segment begins with the next one.
  open_ = std::min(kept_, std::max<std::size_t>(committed_knots_, 1) - 1);
}

bool PublishedCurve::has_room(std::size_t knots, core::Time keep) const noexcept {
  return has_room_behind(has_changes_ ? number_of(window_.knots()) : newest_, knots, keep);
}

bool PublishedCurve::has_room_to_enter(core::Time t, std::size_t knots,
                                       core::Time keep) const noexcept {
  return has_room_behind(segment_at(t), knots, keep);
}

bool PublishedCurve::has_room_behind(Word number, std::size_t knots,
                                     core::Time keep) const noexcept {
  if (keep == core::Time::max()) return true;  // a recorded stream keeps nothing
  const Word newest = number + knots;
  const Word lost = newest - std::min<Word>(newest, board_->capacity());
  if (lost < std::max<Word>(first_, 1) || lost >= newest_) return true;
  return published_->time_hint(lost + 1) <= keep;  // where the last segment that is lost ends
}

core::Time PublishedCurve::earliest_entry() const noexcept {
  core::Time left{};
  SegmentForm form{};
  if (newest_ == 0 || !published_->copy_time(first_, board_->revision(), left, form)) {
    return core::Time::max();
  }
  const bool is_held = first_ == 1 && !window_.is_entered() && window_.options().held_before_start;
  return is_held ? core::Time::min() : left;
}

/// The last committed segment whose left end is at or before t; else the first one. By the packed
/// times, which are this writer's own.
Word PublishedCurve::segment_at(core::Time t) const noexcept {
  Word low = first_;
  Word high = newest_;
  while (low < high) {
    const Word middle = high - (high - low) / 2;
    if (published_->time_hint(middle) <= t) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

/// Reads a committed knot; one that cannot be leaves the curve damaged.
bool PublishedCurve::read_knot(Word number, KnotCopy& out) noexcept {
  const bool is_there = published_->copy_knot(number, board_->revision(), out);
  is_damaged_ = is_damaged_ || !is_there;
  return is_there;
}

/// The last waypoints on the curve before t, oldest first. From segment `number` on, behind which
/// a hold may have been written for the next revision.
std::span<const core::StandingWaypoint> PublishedCurve::standing_before(Word number, bool is_held,
                                                                        core::Time t) noexcept {
  const std::size_t dimensions = window_.dimensions();
  std::size_t found = 0;
  int looked_at = is_held ? 1 : 0;
  for (; number >= std::max<Word>(first_, 1) && found < standing_.size(); --number) {
    if (!read_knot(number, knot_)) return {};
    if (knot_.note.form == SegmentForm::none) continue;
    if (++looked_at > kStandingLookBack) break;
    if (!knot_.note.is_waypoint || knot_.time >= t) continue;
    const auto values = std::span(standing_values_).subspan(found * dimensions, dimensions);
    std::ranges::copy(knot_.waypoint(), values.begin());
    is_damaged_ = is_damaged_ || !are_numbers(values);
    ++found;
    standing_[standing_.size() - found] = {knot_.time, values};
  }
  return std::span(standing_).last(found);
}

void PublishedCurve::note_change(core::Time from) noexcept {
  changed_from_ = std::min(changed_from_, from);
  has_changes_ = true;
}

void PublishedCurve::begin(const core::Instant& state) noexcept {
  window_.enter(state, {});
  is_entry_new_ = true;
  note_change(state.time);
}

/// Finds what a run that is entered at t goes on from: reads, and changes nothing but scratch.
PublishedCurve::Way PublishedCurve::way_at(core::Time t) noexcept {
  Way way{.time = t, .cut = segment_at(t)};
  if (!read_segment(way.cut)) return way;
  evaluate_at_cut({read_.left(), read_.right(), read_.order(), read_.coefficients()}, t, state_);
  way.run = way.cut;
  way.ends = t >= read_.right();
  if (way.cut == first_ && t <= read_.left()) {  // nothing stands before it
    way.cut = 0;
    // It keeps its bits: readers are held there before it.
    if (way.run == 1) {
      std::ranges::copy(read_.coefficients().first(window_.dimensions()),
                        state_.ref().position.begin());
    }
  } else if (t == read_.left()) {
    // The segment before keeps their common knot; or that one has been cut already.
    const auto before = segment_before(*published_, head_, way.cut);
    is_damaged_ = is_damaged_ || !before || *before == 0;
    if (is_damaged_ || !read_segment(*before)) return way;
    way.keeps_right = *before + 1 == way.cut;
    way.run = way.keeps_right ? way.cut + 1 : way.cut;
    way.cut = *before;
  } else if (way.ends) {
    way.is_held = t > read_.right();
    way.run = way.cut + (way.is_held ? 2 : 1);
  } else {
    way.keeps_right = read_.kind() != core::SegmentKind::hold;
    way.run = way.cut + (way.keeps_right ? 2 : 1);
  }
  const core::StateRef state = state_.ref();
  if (way.run > 1) {
    kinds_.normalise_quaternions(state.position, state.velocity, state.acceleration);
  }
  way.standing = standing_before(way.cut, way.is_held, t);
  return way;
}

core::Instant PublishedCurve::state_on(const Way& way) const noexcept {
  return {.time = way.time,
          .position = state_.position(),
          .velocity = state_.velocity(),
          .acceleration = state_.acceleration()};
}

std::span<const double> PublishedCurve::plan_entry(core::Time t) noexcept {
  way_ = way_at(t);
  return state_.position();
}

bool PublishedCurve::can_enter_with(std::span<const core::Waypoint> waypoints) noexcept {
  if (!trial_) return true;
  trial_->enter(state_on(way_), way_.standing);
  return trial_->keeps_in_entry(waypoints);
}

void PublishedCurve::enter_as_planned() noexcept {
  if (is_damaged_) return;
  note_change(way_.time);
  cut(way_);
  run_ = way_.run;
  window_.enter(state_on(way_), way_.standing);
  committed_knots_ = 0;
  is_entry_new_ = true;
  kept_ = 0;
  open_ = 0;
}

/// Writes what a run that is entered makes of the segment before it, which has been read.
void PublishedCurve::cut(const Way& way) noexcept {
  if (way.cut == 0) return;
  const auto position_at = [&](core::Time t) {
    const auto position = std::span(segment_.acceleration_step);
    core::evaluate_derivative(read_.order(), read_.coefficients(),
                              core::to_seconds(t - read_.left()), 0, position);
    return position;
  };
  if (way.is_held) {
    write_given(way.cut + 1, SegmentForm::hold, read_.right(), position_at(read_.right()));
  }
  if (way.ends) return;  // it ends as it is
  if (way.keeps_right && way.cut < newest_) {
    board_->write_form(way.cut + 1, SegmentForm::none, way.time);
  } else if (way.keeps_right) {
    // A stop: how long it would have taken stands at its right knot.
    const core::Time end = read_.natural_right();
    write_given(way.cut + 1, SegmentForm::none, end, position_at(end), way.time);
  }
  board_->write_form(way.cut, read_.left_knot().note.form);
}

/// Reads a committed segment that is to be cut, or lies before the cut; one that cannot be leaves
/// the curve damaged: nobody else writes.
bool PublishedCurve::read_segment(Word number) noexcept {
  const bool is_whole = read_.take(*published_, head_, number) == BoardSegment::Taken::whole &&
                        is_time_in_range(read_.left());
  is_damaged_ = is_damaged_ || !is_whole;
  return is_whole;
}

/// Writes a knot at rest that no window knows of.
void PublishedCurve::write_given(Word number, SegmentForm form, core::Time time,
                                 std::span<const double> position, core::Time begins) noexcept {
  const auto zeros = std::span(kZeros).first(position.size());
  const bool is_splice = form == SegmentForm::splice;
  board_->write(number, {.is_new = true,
                         .note = {.form = form, .starts = is_splice},
                         .time = time,
                         .begins = begins,
                         .position = position,
                         .velocity = zeros,
                         .acceleration = is_splice ? zeros : zeros.first(0),
                         .residual = published_->smooths() ? zeros : zeros.first(0)});
}

void PublishedCurve::append(const core::Waypoint& waypoint, Word item) noexcept {
  if (window_.knots() == 0) run_item_ = item;
  window_.append(waypoint);
  has_changes_ = true;
  // What has settled leaves the window and is written once, with its last value.
  const std::size_t settled = window_.settled_knots();
  if (open_ >= settled) return;
  if (is_entry_open()) write_entry();
  write_knots(open_, settled);
  open_ = settled;
}

void PublishedCurve::finish(const core::Condition& end, core::Time earliest) noexcept {
  const std::size_t knots = window_.knots();
  if (window_.frozen_knots() < knots || (knots == 0 && !window_.is_entered())) {
    window_.finish(end);
    has_changes_ = true;
    // The last segment may come to a full stop, which is another form.
    open_ = std::min(open_, knots - std::min<std::size_t>(knots, 2));
  } else if (knots > 0) {
    // What stands of the run stays as it is.
    return_to(window_.knot(knots - 1), earliest);
  }
}

/// Lets the stop run and goes back to the newest knot, behind it.
void PublishedCurve::return_to(const core::Knot& knot, core::Time earliest) noexcept {
  const auto way = way_back(window_, knot, segment_, state_);
  if (!way) return;
  const core::Time start = std::max(way->rest, earliest);
  const Word newest = number_of(window_.knots() - 1);
  const auto at = [&] { return newest + ++besides_; };
  if (start > way->rest) write_given(at(), SegmentForm::hold, way->rest, state_.position());
  write_given(at(), SegmentForm::splice, start, state_.position());
  const core::Time end = start + way->duration;
  const auto zeros = std::span(kZeros).first(window_.dimensions());
  board_->write(at(), {.is_new = true,
                       .note = {.arrives = true},
                       .time = end,
                       .begins = end,
                       .position = knot.position,
                       .velocity = zeros,
                       .acceleration = zeros,
                       .residual = published_->smooths() ? zeros : zeros.first(0)});
  // Until then the stop and the hold are what readers see anyway.
  note_change(start);
  end_ = end;
}

/// Writes the state that the run begins in, as it is now left.
void PublishedCurve::write_entry() noexcept {
  const core::Instant from = window_.entry().state();
  const bool is_splice = window_.knots() > 0;
  const auto zeros = std::span(kZeros).first(published_->smooths() ? window_.dimensions() : 0);
  board_->write(run_, {.is_new = is_entry_new_,
                       .note = {.form = is_splice ? SegmentForm::splice : SegmentForm::stop,
                                .starts = true,
                                .newer_knots = window_.newer_knots_seen_by_entry()},
                       .time = from.time,
                       .position = from.position,
                       .velocity = from.velocity,
                       .acceleration = from.acceleration,
                       .residual = zeros,
                       .item = is_splice ? run_item_ + 1 : 0});
  note_change(from.time);
}

/// Of the knots before this one an append changes nothing but the velocity.
std::size_t PublishedCurve::plain_knots() const noexcept {
  const bool is_plain = has_plain_knots_ && !window_.finished() && committed_knots_ > kFirstKnots;
  return is_plain ? committed_knots_ - look_ahead_ : 0;
}

/// Writes knots of the run as the window has them now, from `first` to the one before `end`.
void PublishedCurve::write_knots(std::size_t first, std::size_t end) noexcept {
  const std::size_t plain_end = std::min(plain_knots(), end);
  std::size_t i = first;
  for (; i < std::min(std::max<std::size_t>(kept_, 1), end); ++i) write_knot(i);
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
  const bool is_new = i >= committed_knots_;
  const bool is_newest = i + 1 == window_.knots();
  const bool ends_splice = i == 0 && window_.is_entered();
  KnotRecord record{
      .is_new = is_new,
      .note = {.form = window_.form(i),
               .is_waypoint = true,
               .arrives = ends_splice || !knot.acceleration.empty(),
               .newer_knots = knot.newer_knots},
      .time = knot.time,
      .begins = knot.time,
      .position = knot.waypoint,
      .velocity = knot.velocity,
      .acceleration = ends_splice ? window_.entry().acceleration() : knot.acceleration,
      .residual = knot.residual};
  record.note.starts = !knot.acceleration.empty();
  const auto stop = std::span(segment_.acceleration_step);
  if (record.note.form == SegmentForm::stop) {
    // Where a segment arrives here with a given acceleration, the stop starts with the same one.
    stop_ = window_.write_stop(stop);
    end_ = knot.time + stop_;
    record.note.starts = true;
    record.acceleration = stop;
  }
  // An append changes rows as far back as its method looks, an entry all of the first ones.
  const std::size_t first_row = committed_knots_ <= kFirstKnots
                                    ? 0
                                    : committed_knots_ - std::min(committed_knots_, look_ahead_);
  if (i >= first_row) {
    record.prefix = &knot.prefix;
    record.g = knot.g;
  }
  board_->write(number_of(i), record);
  const bool was_stop = i + 1 == committed_knots_ && !is_newest;
  if (i >= kept_) {
    note_change(i > 0 ? window_.time(i - 1) : knot.time);
  } else if (was_stop || window_.finished()) {
    note_change(knot.time);
  }
}

void PublishedCurve::write(Head& head) noexcept {
  head.changed_from = changed_from_;
  changed_from_ = core::Time::max();
  head.run_frozen = window_.frozen_knots();
  if (!has_changes_) return;
  const std::size_t knots = window_.knots();
  const bool is_entered = window_.is_entered();
  if (knots == 0 && !is_entered) return;
  if (besides_ == 0) {
    if (is_entry_open()) write_entry();
    write_knots(open_, knots);
    newest_ = knots > 0 ? number_of(knots - 1) : run_;
    if (knots == 0) {
      stop_ = window_.write_stop(segment_.acceleration_step);
      end_ = window_.entry().time() + stop_;
    } else if (window_.finished()) {
      stop_ = core::Time::zero();
      end_ = window_.knot(knots - 1).time;
    }
  } else {
    newest_ = number_of(knots - 1) + besides_;
    stop_ = core::Time::zero();
  }
  head.changed_from = std::min(head.changed_from, changed_from_);
  changed_from_ = core::Time::max();
  // Never back: a replacement drops knots, but the slots that they took are not given back.
  const Word kept = newest_ - std::min<Word>(newest_, board_->capacity()) + 1;
  if (kept > first_) {
    first_ = kept;
    // A segment begins at the first knot: where none does, the one before has been lost.
    if (first_ < newest_ && board_->form(first_) == SegmentForm::none) ++first_;
  }
  head.newest = newest_;
  head.stop = stop_;
  head.run = run_;
  head.run_knots = knots;
  head.is_entered = is_entered;
  head.first = first_;
}

void PublishedCurve::committed(const Head& head) noexcept {
  has_changes_ = false;
  is_entry_new_ = false;
  head_ = head;
  committed_knots_ = window_.knots();
  keep_settled();
}

void PublishedCurve::restore(const Head& head) noexcept {
  has_changes_ = false;
  is_entry_new_ = false;
  changed_from_ = core::Time::max();
  besides_ = 0;
  head_ = head;
  run_ = head.run;
  first_ = head.first;
  newest_ = head.newest;
  stop_ = head.stop;
  end_ = {};
  committed_knots_ = head.run_knots;
  is_damaged_ = false;
  if (newest_ > 0) {
    is_damaged_ = !read_.take_last(*published_, head_);
    end_ = read_.right();
  }
  if (!head.finished && !is_damaged_) restore_run();
  keep_settled();
}

namespace {

/// Whether the knots of a head's run, which goes on, are the newest ones.
bool describes_a_run(const Head& head) noexcept {
  if (head.newest == 0) return head.run_knots == 0 && !head.is_entered;
  const Word knots = head.run_knots + (head.is_entered ? 1 : 0);
  return head.run >= 1 && head.run <= head.newest && knots == head.newest - head.run + 1 &&
         head.run_knots <= knots;
}

}  // namespace

/// A committed knot as the window had it; `values` is where its spans lie. What is none leaves the
/// curve damaged.
core::Knot PublishedCurve::restore_knot(Word number, std::span<double> values) noexcept {
  if (!read_knot(number, knot_)) return {};
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

/// How the run was entered.
core::SlidingWindow::Entry PublishedCurve::restore_entry() noexcept {
  const core::Knot state = restore_knot(run_, entry_values_);
  run_item_ = knot_.item > 0 ? knot_.item - 1 : 0;
  const bool is_earlier = knots_.empty() || state.time < knots_.front().time;
  const bool arrives = knots_.empty() || !knots_.front().acceleration.empty();
  is_damaged_ = is_damaged_ || state.acceleration.empty() || !is_earlier || !arrives;
  if (is_damaged_) return {};
  return {.from = {.time = state.time,
                   .position = state.position,
                   .velocity = state.velocity,
                   .acceleration = state.acceleration},
          .before = standing_before(run_ - 1, false, state.time),
          .acceleration = knots_.empty() ? std::span<const double>() : knots_.front().acceleration,
          .newer_knots = state.newer_knots};
}

void PublishedCurve::restore_run() noexcept {
  if (!describes_a_run(head_)) {
    is_damaged_ = true;
    return;
  }
  const std::size_t size = kKnotValues * window_.dimensions();
  const std::size_t count = std::min<std::size_t>(head_.run_knots, window_.knots_to_restore());
  const std::size_t first = head_.run_knots - count;
  const Word first_number = run_ + (head_.is_entered ? 1 : 0) + first;
  knots_.clear();
  for (std::size_t k = 0; k < count && !is_damaged_; ++k) {
    knots_.push_back(
        restore_knot(first_number + k, std::span(knot_values_).subspan(size * k, size)));
    const bool is_later = k == 0 || knots_[k].time > knots_[k - 1].time;
    is_damaged_ = is_damaged_ || !knot_.note.is_waypoint || !is_later;
  }
  if (is_damaged_) return;
  if (!head_.is_entered) return window_.restore(first, knots_);
  core::SlidingWindow::Entry entry{};
  if (first == 0) entry = restore_entry();
  if (!is_damaged_) window_.restore_entered(entry, first, knots_);
}

}  // namespace splinecast::ipc
