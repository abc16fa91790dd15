#include "splinecast/core/sliding_window.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

namespace splinecast::core {
namespace {

WindowOptions checked(WindowOptions options, std::size_t dimensions) {
  if (dimensions < kMinDimensions || dimensions > kMaxDimensions) {
    throw std::invalid_argument("dimensions must be 1 to 64, not " + std::to_string(dimensions));
  }
  if (options.settle > kMaxSettle) {
    throw std::invalid_argument("settle lag must be 0 to 64, not " +
                                std::to_string(options.settle));
  }
  if (options.stop_time <= Time::zero()) {
    throw std::invalid_argument("stop time must be positive, not " +
                                std::to_string(options.stop_time.count()) + " ns");
  }
  require_values(options.start, dimensions);
  return options;
}

}  // namespace

SlidingWindow::SlidingWindow(std::size_t dimensions, WindowOptions options)
    : options_(checked(std::move(options), dimensions)),
      knots_(dimensions, knots_to_restore() + 1, options_.start) {}

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

void SlidingWindow::append(Time time, std::span<const double> position) noexcept {
  knots_.push(time, position);
  knots_.close(options_.tail);
  const std::size_t newest = knots_.newest();
  knots_.back_substitute_to(newest - std::min(newest, options_.settle));
}

void SlidingWindow::finish(const Condition& end) noexcept {
  finished_ = true;
  if (knots() == 0) return;
  knots_.close(end);
  const std::size_t newest = knots_.newest();
  // Until K knots have followed it, knot 0 too is still open.
  knots_.back_substitute_to(newest < options_.settle ? 0 : newest - (reach() - 1));
}

void SlidingWindow::segment(std::size_t i, Segment& out) const noexcept {
  if (i == knots_.newest()) {
    if (finished_) {
      build_hold(knots_.knot(i).time, knots_.knot(i).position, out);
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
  if (n > 0) {
    const Interval last = knots_.interval(n - 1);
    for (std::size_t d = 0; d < dimensions(); ++d) acceleration[d] = right_acceleration(last, d);
  }
  build_stop_tail(knot.time, options_.stop_time, knot.position, knot.velocity,
                  std::span(acceleration).first(dimensions()), out);
}

void SlidingWindow::restore(std::size_t first, std::span<const Knot> knots) noexcept {
  knots_.restore(first, knots);
}

}  // namespace splinecast::core
