#include "core/online/sliding_window.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/forms/entry.hpp"
#include "core/forms/stop.hpp"
#include "core/limits/limit_of.hpp"
#include "core/solvers/run_start.hpp"

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
  if (method.smooths() && !options.accepts_short_lag &&
      static_cast<double>(options.settle) < shortest) {
    throw std::invalid_argument("settle lag " + std::to_string(options.settle) +
                                " is too short for smoothing: at least " +
                                std::to_string(static_cast<int>(shortest)) + " is needed");
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
  if (options.stop_length <= Time::zero()) {
    throw std::invalid_argument("stop time must be positive, not " +
                                std::to_string(options.stop_length.count()) + " ns");
  }
  if (!(options.max_rate > 0)) {
    throw std::invalid_argument("largest rate must be above 0, not " +
                                std::to_string(options.max_rate));
  }
  require_values(options.start, dimensions);
  return options;
}

}  // namespace

std::size_t default_settle(const Method& method) noexcept {
  constexpr std::size_t kDefaultSettle = 8;
  if (method.smooths()) return kMaxSettle;
  return method.converges() ? kDefaultSettle : method.look_ahead;
}

WindowOptions with_kinds(WindowOptions options, const DimensionKinds& kinds) {
  options.kinds = kinds;
  return options;
}

SlidingWindow::SlidingWindow(std::size_t dimensions, WindowOptions options)
    : options_(checked(std::move(options), dimensions)),
      limits_at_largest_rate_(limits_at_rate(options_.limits, options_.max_rate)),
      knots_(dimensions, knots_to_restore() + 1, *options_.interpolant.method,
             options_.start.kind == ConditionKind::halt),
      solver_(make_knot_solver(options_.interpolant, options_.start, dimensions, Use::online)),
      run_start_(dimensions) {}

std::size_t SlidingWindow::segments() const noexcept {
  return finished_ && knots() > 1 ? knots() - 1 : knots();
}

std::size_t SlidingWindow::settled_segments() const noexcept {
  if (finished_) return segments();
  const std::size_t converged = knots() - std::min(knots(), reach() + 1);
  return std::max(converged, frozen_ - std::min<std::size_t>(frozen_, 1));
}

std::size_t SlidingWindow::settled_knots() const noexcept {
  if (finished_) return knots();
  const std::size_t segments = settled_segments();
  return segments > 0 ? segments + 1 : frozen_;
}

SegmentForm SlidingWindow::form(std::size_t i) const noexcept {
  if (i < knots_.newest()) return knots_.form(i);
  if (!finished_) return SegmentForm::stop;
  return knots() == 1 ? SegmentForm::hold : SegmentForm::none;
}

std::size_t SlidingWindow::oldest_knot() const noexcept {
  return std::max(first_, knots() - std::min(knots(), reach() + 2));
}

std::size_t SlidingWindow::oldest_segment() const noexcept { return oldest_knot(); }

bool SlidingWindow::takes(const Waypoint& waypoint) const noexcept {
  const Method& method = *options_.interpolant.method;
  return (!method.needs_velocity() || !waypoint.velocity.empty()) &&
         (!method.needs_acceleration() || !waypoint.acceleration.empty());
}

bool SlidingWindow::lag_suffices(Time time) const noexcept {
  const std::size_t lag = options_.settle;
  const bool smooths = options_.interpolant.method->smooths();
  if (!smooths || options_.accepts_short_lag || knots() < lag) return true;
  const double ahead = to_seconds(time - knots_.row(knots() - lag).time);
  return static_cast<double>(lag) >=
         smoothing_lag(options_.interpolant.lambda, ahead / static_cast<double>(lag));
}

void SlidingWindow::solve(const auto& closing, std::size_t last) noexcept {
  // `finish` changes the newest knot even if it is frozen.
  const std::size_t first = std::min(std::max(last, frozen_), knots_.newest());
  solver_->solve(knots_, closing, first);
  knots_.mark_solved(first);
}

/// Sets the velocity of knot 0 from the positions of the waypoints, unless the waypoints carry
/// velocities.
void SlidingWindow::start_with_waypoints() noexcept {
  if (options_.interpolant.method->needs_velocity()) return;
  write_run_start(knots_, run_start_);
  solver_->start_with(run_start_);
  solver_->eliminate_again(knots_);
  if (knots() == 1) {
    std::ranges::copy(run_start_, knots_.values(0, KnotRing::kVelocity).begin());
  }
}

/// Appends one of the first kKnotsThatShapeTheStart knots of a later run. Eliminates the same rows
/// whether or not knots are frozen: a frozen velocity is not a boundary condition, and rows depend
/// on the waypoints only.
void SlidingWindow::append_to_start(const Waypoint& waypoint) noexcept {
  solver_->push(knots_, waypoint);
  start_with_waypoints();
  solve(options_.tail, first_to_solve(knots_.newest()));
}

void SlidingWindow::append(const Waypoint& waypoint) noexcept {
  if (is_later_run_ && knots() < kKnotsThatShapeTheStart) return append_to_start(waypoint);
  const std::size_t first = first_to_solve(knots());
  solver_->append(knots_, waypoint, options_.tail, first);
  knots_.mark_solved(first);
}

void SlidingWindow::begin_run() noexcept {
  is_later_run_ = true;
  first_ = 0;
  frozen_ = 0;
  finished_ = false;
  knots_.clear(false);
  // Given velocities are kept: the start condition was that of the first run.
  if (options_.interpolant.method->needs_velocity()) solver_->start_as_given();
}

void SlidingWindow::freeze(Time t) noexcept {
  // Knots that have left the window count as frozen.
  freeze_knots(oldest_knot());
  // Freezes up to the right knot of the segment that contains t: the first knot after t.
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
  if (newest == 0 && is_later_run_) return rest_at_only_knot();
  // Knot 0 may still change until K knots follow it.
  const bool from_start = newest < options_.settle || is_start_open(newest);
  const std::size_t first = from_start ? 0 : newest - (reach() - 1);
  if (end.kind != ConditionKind::own) return solve(end, first);
  solve(Condition{.kind = options_.interpolant.method->traits.own_end, .value = {}}, first);
}

/// Sets the velocity of the only knot of a later run to 0, under any end condition: its segment is
/// a hold.
void SlidingWindow::rest_at_only_knot() noexcept {
  std::ranges::fill(knots_.values(0, KnotRing::kVelocity), 0.0);
}

void SlidingWindow::segment(std::size_t i, Segment& out) const noexcept {
  if (i < knots_.newest()) {
    const Interval interval = knots_.interval(i);
    build_segment(interval, out);
    write_acceleration_step(knots_, i, interval, options_.held_before_start, out.acceleration_step);
    return;
  }
  const Knot knot = knots_.knot(i);
  std::ranges::fill(out.acceleration_step, 0.0);
  if (finished_) return build_hold(knot.time, knot.time, knot.position, out);
  std::array<double, kMaxDimensions> values{};
  const auto acceleration = std::span(values).first(dimensions());
  const Time length = write_stop(acceleration);
  build_stop(knot.time, length, knot.position, knot.velocity, acceleration, out);
}

Time SlidingWindow::write_stop(std::span<double> acceleration) const noexcept {
  knots_.write_final_acceleration(acceleration);
  // A given acceleration is also that with which the segment before arrives.
  if (!kinds().quaternions().empty() && !options_.interpolant.method->needs_acceleration()) {
    align_rotations(kinds(), knots_.values(knots_.newest(), KnotRing::kVelocity), acceleration);
  }
  return stop_length(acceleration);
}

Time SlidingWindow::stop_length(std::span<const double> acceleration) const noexcept {
  const std::size_t newest = knots_.newest();
  return stop_time_within(stop_rules(), {.time = knots_.row(newest).time,
                                         .position = knots_.position(newest),
                                         .velocity = knots_.values(newest, KnotRing::kVelocity),
                                         .acceleration = acceleration});
}

void SlidingWindow::write_acceleration(std::size_t i,
                                       std::span<double> acceleration) const noexcept {
  if (i < knots_.newest()) {
    write_left_acceleration(knots_.interval(i), acceleration);
  } else {
    knots_.write_final_acceleration(acceleration);
  }
}

void SlidingWindow::restore(std::size_t first, std::span<const Knot> knots) noexcept {
  is_later_run_ = false;
  first_ = first;
  frozen_ = 0;
  finished_ = false;
  solver_->start_as_first();
  knots_.clear(options_.start.kind == ConditionKind::halt);
  knots_.restore(first, knots);
}

void SlidingWindow::restore_run(std::size_t first, std::span<const Knot> knots) noexcept {
  begin_run();
  first_ = first;
  knots_.restore(first, knots);
  if (first > 0 || knots.empty()) return;
  // The rows are already eliminated: only the start condition is missing.
  if (!options_.interpolant.method->needs_velocity()) {
    write_run_start(knots_, run_start_);
    solver_->start_with(run_start_);
  }
}

void SlidingWindow::copy_from(const SlidingWindow& other, std::span<Knot> scratch) noexcept {
  const std::size_t first = other.first_to_restore();
  const auto knots = scratch.first(other.knots() - first);
  for (std::size_t i = 0; i < knots.size(); ++i) knots[i] = other.knot(first + i);
  if (other.is_later_run()) {
    restore_run(first, knots);
  } else {
    restore(first, knots);
  }
  freeze_knots(other.frozen_knots());
}

}  // namespace splinecast::core
