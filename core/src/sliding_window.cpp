#include "splinecast/core/sliding_window.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

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
      solver_(make_knot_solver(options_.interpolant, options_.start, Use::online)) {}

std::size_t SlidingWindow::segments() const noexcept {
  return finished_ && knots() > 1 ? knots() - 1 : knots();
}

std::size_t SlidingWindow::settled_segments() const noexcept {
  if (finished_) return segments();
  return knots() - std::min(knots(), reach() + 1);
}

std::size_t SlidingWindow::oldest_segment() const noexcept {
  return knots() - std::min(knots(), reach() + 2);
}

std::size_t SlidingWindow::newer_knots_seen(std::size_t i) const noexcept {
  return std::min(knots_.newest() - i, options_.settle);
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

/// An exact method's slope at the start may look one knot further than the slopes within: knot 0
/// stays open as long as its segment does.
bool SlidingWindow::is_start_open() const noexcept {
  return !options_.interpolant.method->converges() && knots_.newest() <= reach() + 1;
}

void SlidingWindow::append(const Waypoint& waypoint) noexcept {
  solver_->push(knots_, waypoint);
  const std::size_t newest = knots_.newest();
  solver_->solve(knots_, options_.tail,
                 is_start_open() ? 0 : newest - std::min(newest, options_.settle));
}

void SlidingWindow::finish(const Condition& end) noexcept {
  finished_ = true;
  if (knots() == 0) return;
  const std::size_t newest = knots_.newest();
  // Until K knots have followed it, knot 0 too is still open.
  const bool from_start = newest < options_.settle || is_start_open();
  const bool is_halt =
      end.kind == ConditionKind::own && options_.interpolant.method->family == Family::tridiagonal;
  solver_->solve(knots_, is_halt ? Condition{.kind = ConditionKind::halt, .value = {}} : end,
                 from_start ? 0 : newest - (reach() - 1));
}

void SlidingWindow::segment(std::size_t i, Segment& out) const noexcept {
  if (i == knots_.newest()) {
    if (finished_) {
      build_hold(knots_.row(i).time, knots_.position(i), out);
    } else {
      write_stop_tail(out);
    }
    std::ranges::fill(out.acceleration_step, 0.0);
    return;
  }
  build_segment(knots_.interval(i), out);
  write_acceleration_step(knots_, i, options_.held_before_start, out.acceleration_step);
}

void SlidingWindow::write_stop_tail(Segment& out) const noexcept {
  const std::size_t n = knots_.newest();
  const Knot knot = knots_.knot(n);
  std::array<double, kMaxDimensions> acceleration{};
  for (std::size_t d = 0; d < dimensions(); ++d) acceleration[d] = knots_.final_acceleration(d);
  build_stop_tail(knot.time, options_.stop_time, knot.position, knot.velocity,
                  std::span(acceleration).first(dimensions()), out);
}

void SlidingWindow::restore(std::size_t first, std::span<const Knot> knots) noexcept {
  knots_.restore(first, knots);
}

}  // namespace splinecast::core
