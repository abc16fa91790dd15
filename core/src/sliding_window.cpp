#include "splinecast/core/sliding_window.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "splinecast/core/limits.hpp"

namespace splinecast::core {
namespace {

void require_lag(const WindowOptions& options) {
  const Method& method = *options.interpolant.method;
  const std::size_t least = method.converges() ? 0 : method.look_ahead;
  if (options.settle < least || options.settle > kMaxSettle) {
    throw std::invalid_argument("settle lag of " + std::string(method.name) + " must be " +
                                std::to_string(least) + " to " + std::to_string(kMaxSettle) +
                                ", not " + std::to_string(options.settle));
  }
  const double shortest = smoothing_lag(0, 1);
  if (method.family == Family::smoothing && !options.force_lag &&
      static_cast<double>(options.settle) < shortest) {
    throw std::invalid_argument("settle lag " + std::to_string(options.settle) +
                                " is too short to smooth with: " +
                                std::to_string(static_cast<int>(shortest)) + " or more are needed");
  }
}

void require_streaming(const WindowOptions& options) {
  const Method& method = *options.interpolant.method;
  if (!method.streams()) {
    throw std::invalid_argument("method " + std::string(method.name) +
                                " needs all waypoints at once: it cannot be solved online");
  }
  if (!is_online(options.start.kind)) {
    throw std::invalid_argument("condition '" + to_string(options.start) +
                                "' needs all waypoints at once: it cannot be met online");
  }
  require_parameters(options.interpolant);
  require_lag(options);
}

WindowOptions checked(WindowOptions options, std::size_t dimensions) {
  if (dimensions < kMinDimensions || dimensions > kMaxDimensions) {
    throw std::invalid_argument("dimensions must be 1 to 64, not " + std::to_string(dimensions));
  }
  require_streaming(options);
  require_limits(options.limits, dimensions);
  if (options.stop_time <= Time::zero()) {
    throw std::invalid_argument("stop time must be positive, not " +
                                std::to_string(options.stop_time.count()) + " ns");
  }
  require_values(options.start, dimensions);
  return options;
}

}  // namespace

std::size_t default_settle(const Method& method) noexcept {
  constexpr std::size_t kDefaultSettle = 8;
  if (method.family == Family::smoothing) return kMaxSettle;
  return method.converges() ? kDefaultSettle : method.look_ahead;
}

SlidingWindow::SlidingWindow(std::size_t dimensions, WindowOptions options)
    : options_(checked(std::move(options), dimensions)),
      knots_(dimensions, knots_to_restore() + 1, *options_.interpolant.method,
             options_.start.kind == ConditionKind::halt),
      solver_(make_knot_solver(options_.interpolant, options_.start, dimensions, Use::online)),
      entry_(dimensions),
      splice_(dimensions) {}

std::size_t SlidingWindow::segments() const noexcept {
  if (is_entered_) return finished_ ? knots() : knots() + 1;
  return finished_ && knots() > 1 ? knots() - 1 : knots();
}

/// Intervals between knots that nothing changes any more.
std::size_t SlidingWindow::settled_knot_segments() const noexcept {
  const std::size_t converged = knots() - std::min(knots(), reach() + 1);
  return std::max(converged, frozen_ - std::min<std::size_t>(frozen_, 1));
}

std::size_t SlidingWindow::settled_segments() const noexcept {
  if (finished_) return segments();
  const std::size_t settled = settled_knot_segments();
  if (!is_entered_) return settled;
  return settled > 0 || frozen_ > 0 ? settled + 1 : 0;
}

std::size_t SlidingWindow::settled_knots() const noexcept {
  if (finished_) return knots();
  const std::size_t segments = settled_knot_segments();
  return segments > 0 ? segments + 1 : frozen_;
}

SegmentForm SlidingWindow::form(std::size_t i) const noexcept {
  if (i < knots_.newest()) return knots_.form(i);
  if (!finished_) return SegmentForm::stop;
  return knots() == 1 && !is_entered_ ? SegmentForm::hold : SegmentForm::none;
}

std::size_t SlidingWindow::oldest_knot() const noexcept {
  return knots() - std::min(knots(), reach() + 2);
}

std::size_t SlidingWindow::oldest_segment() const noexcept {
  const std::size_t oldest = oldest_knot();
  return is_entered_ && oldest > 0 ? oldest + 1 : oldest;
}

bool SlidingWindow::takes(const Waypoint& waypoint) const noexcept {
  const Method& method = *options_.interpolant.method;
  return (!method.needs_velocity() || !waypoint.velocity.empty()) &&
         (!method.needs_acceleration() || !waypoint.acceleration.empty());
}

bool SlidingWindow::lag_suffices(Time time) const noexcept {
  const std::size_t lag = options_.settle;
  const bool smooths = options_.interpolant.method->family == Family::smoothing;
  if (!smooths || options_.force_lag || knots() < lag) return true;
  const double ahead = to_seconds(time - knots_.row(knots() - lag).time);
  return static_cast<double>(lag) >=
         smoothing_lag(options_.interpolant.lambda, ahead / static_cast<double>(lag));
}

void SlidingWindow::solve(const auto& closing, std::size_t last) noexcept {
  const std::size_t newest = knots_.newest();
  // A finish changes the newest knot even where it has been frozen as a knot to pass through.
  const std::size_t first = std::min(std::max(last, frozen_), newest);
  solver_->solve(knots_, closing, first);
  knots_.mark_solved(first);
  // Until both its knots have converged, the first interval shapes the splice before it.
  if (!is_entry_open() || first > 1) return;
  entry_.take_acceleration(knots_);
  entry_newer_knots_ = static_cast<std::uint32_t>(newest);
}

/// For window_limits.cpp.
template void SlidingWindow::solve(const Tail&, std::size_t) noexcept;

/// Makes the entry's velocity that of knot 0, unless the waypoint gives one; a given acceleration
/// is the one that the splice ends with.
void SlidingWindow::start_with_entry() noexcept {
  const Method& method = *options_.interpolant.method;
  if (method.needs_acceleration()) {
    entry_.take(knots_.values(0, KnotRing::kVelocity), knots_.values(0, KnotRing::kAcceleration));
  }
  if (method.needs_velocity()) return;
  solver_->start_with(entry_.velocity());
  solver_->eliminate_again(knots_);
  if (knots() == 1) {
    std::ranges::copy(entry_.velocity(), knots_.values(0, KnotRing::kVelocity).begin());
  }
}

/// Appends to a run whose entry is open. Returns whether the entry's velocity has changed.
bool SlidingWindow::push_into_entry(const Waypoint& waypoint) noexcept {
  solver_->push(knots_, waypoint);
  const bool shapes = is_entry_open() && knots() <= kKnotsThatShapeTheEntry;
  if (shapes) {
    entry_.update(knots_);
    start_with_entry();
  }
  const std::size_t newest = knots_.newest();
  solve(options_.tail, first_to_solve(newest));
  // With K = 0 the splice is shaped by knots behind which its own right knot is not solved again.
  if (shapes) entry_newer_knots_ = static_cast<std::uint32_t>(newest);
  return shapes;
}

void SlidingWindow::append(const Waypoint& waypoint) noexcept {
  if (is_entry_open()) return append_to_entry(waypoint);
  const std::size_t first = first_to_solve(knots());
  solver_->append(knots_, waypoint, options_.tail, first);
  knots_.mark_solved(first);
}

/// The same while the splice of the entry is open: see can_append for what limits ask of it.
void SlidingWindow::append_to_entry(const Waypoint& waypoint) noexcept {
  const bool is_limited = !options_.limits.acceleration.empty();
  if (is_limited) entry_.keep();
  const bool shapes = push_into_entry(waypoint);
  if (!is_limited || knots() == 1) return;
  entry_.write_splice(knots_, splice_);
  if (keeps_within(options_.limits.acceleration, splice_)) return;
  if (shapes) {
    take_better_entry();
  } else {
    entry_.restore_acceleration();
  }
}

void SlidingWindow::enter(const Instant& from, std::span<const StandingWaypoint> before) noexcept {
  entry_.begin(from, before);
  is_entered_ = true;
  frozen_ = 0;
  finished_ = false;
  entry_newer_knots_ = 0;
  knots_.clear(false);
  // Given velocities are kept: the start condition was that of the first run.
  if (options_.interpolant.method->needs_velocity()) solver_->start_as_given();
}

void SlidingWindow::freeze(Time t) noexcept {
  // What has left the window needs no freezing.
  freeze_knots(oldest_knot());
  if (is_entry_open() && t >= entry_.time()) freeze_knots(1);
  // Frozen is the right knot of the segment that contains t: the first one that is later.
  while (frozen_ < knots() &&
         (frozen_ == 0 ? t >= knots_.row(0).time : t >= knots_.row(frozen_ - 1).time)) {
    ++frozen_;
  }
}

void SlidingWindow::freeze_knots(std::size_t count) noexcept {
  frozen_ = std::max(frozen_, std::min(count, knots()));
}

void SlidingWindow::finish(const Condition& end) noexcept {
  finished_ = true;
  if (knots() == 0) return;
  const std::size_t newest = knots_.newest();
  if (newest == 0 && is_entered_) return rest_at_only_knot();
  // Until K knots have followed it, knot 0 too is still open.
  const bool from_start = newest < options_.settle || is_start_open(newest);
  const bool is_halt =
      end.kind == ConditionKind::own && options_.interpolant.method->family == Family::tridiagonal;
  solve(is_halt ? Condition{.kind = ConditionKind::halt, .value = {}} : end,
        from_start ? 0 : newest - (reach() - 1));
}

/// A run of one knot ends at rest there, whatever the condition: nothing else gives it a slope.
void SlidingWindow::rest_at_only_knot() noexcept {
  constexpr std::array<double, kMaxDimensions> kZeros{};
  const auto zeros = std::span(kZeros).first(dimensions());
  std::ranges::copy(zeros, knots_.values(0, KnotRing::kVelocity).begin());
  entry_.take(zeros, zeros);
}

void SlidingWindow::segment(std::size_t i, Segment& out) const noexcept {
  const auto left = left_knot(i);
  if (!left && knots() > 0) {
    entry_.write_splice(knots_, out);
    std::ranges::fill(out.acceleration_step, 0.0);
  } else if (!left) {
    const Instant from = entry_.state();
    build_stop_tail(from.time, stop_time(from.velocity, from.acceleration), from.position,
                    from.velocity, from.acceleration, out);
    std::ranges::fill(out.acceleration_step, 0.0);
  } else if (*left < knots_.newest()) {
    const Interval interval = knots_.interval(*left);
    build_segment(interval, out);
    write_step(*left, interval, out);
  } else if (finished_) {
    build_hold(knots_.row(*left).time, knots_.row(*left).time, knots_.position(*left), out);
    std::ranges::fill(out.acceleration_step, 0.0);
  } else {
    write_stop_tail(out);
    std::ranges::fill(out.acceleration_step, 0.0);
  }
}

/// The acceleration step at knot i, at which an interval begins.
void SlidingWindow::write_step(std::size_t i, const Interval& interval,
                               Segment& out) const noexcept {
  if (i > 0 || !is_entered_) {
    write_acceleration_step(knots_, i, interval, options_.held_before_start, out.acceleration_step);
    return;
  }
  write_left_acceleration(interval, out.acceleration_step);
  for (std::size_t d = 0; d < dimensions(); ++d) {
    out.acceleration_step[d] -= entry_.acceleration()[d];
  }
}

Time SlidingWindow::stop_time(std::span<const double> velocity,
                              std::span<const double> acceleration) const noexcept {
  if (options_.limits.acceleration.empty()) return options_.stop_time;
  return stop_time_within(options_.limits.acceleration, options_.stop_time, velocity, acceleration);
}

Time SlidingWindow::write_stop(std::span<double> acceleration) const noexcept {
  const bool follows_splice = knots() == 1 && is_entered_;
  if (knots() == 0) {
    std::ranges::copy(entry_.state().acceleration, acceleration.begin());
    return stop_time(entry_.state().velocity, acceleration);
  }
  if (follows_splice) {
    std::ranges::copy(entry_.acceleration(), acceleration.begin());
  } else {
    knots_.write_final_acceleration(acceleration);
  }
  return stop_time(knots_.values(knots_.newest(), KnotRing::kVelocity), acceleration);
}

void SlidingWindow::write_stop_tail(Segment& out) const noexcept {
  const Knot knot = knots_.knot(knots_.newest());
  std::array<double, kMaxDimensions> values{};
  const auto acceleration = std::span(values).first(dimensions());
  const Time length = write_stop(acceleration);
  build_stop_tail(knot.time, length, knot.position, knot.velocity, acceleration, out);
}

void SlidingWindow::assign(const SlidingWindow& other) noexcept {
  knots_ = other.knots_;
  entry_ = other.entry_;
  if (other.is_entered_) entry_.lead_in(knots_);
  solver_->start_as(*other.solver_);
  is_entered_ = other.is_entered_;
  entry_newer_knots_ = other.entry_newer_knots_;
  frozen_ = other.frozen_;
  finished_ = other.finished_;
}

void SlidingWindow::restore(std::size_t first, std::span<const Knot> knots) noexcept {
  is_entered_ = false;
  frozen_ = 0;
  finished_ = false;
  solver_->start_as_first();
  knots_.clear(options_.start.kind == ConditionKind::halt);
  knots_.restore(first, knots);
}

void SlidingWindow::restore_entered(const Entry& entry, std::size_t first,
                                    std::span<const Knot> knots) noexcept {
  enter(entry.from, entry.before);
  knots_.restore(first, knots);
  if (first > 0 || knots.empty()) return;
  entry_.update(knots_);
  entry_.take(knots[0].velocity, entry.acceleration);
  entry_newer_knots_ = entry.newer_knots;
  // Rows stand as they were eliminated; only the condition behind them is taken up again.
  if (!options_.interpolant.method->needs_velocity()) solver_->start_with(knots[0].velocity);
}

}  // namespace splinecast::core
