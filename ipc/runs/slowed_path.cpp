#include "ipc/runs/slowed_path.hpp"

#include "core/forms/knot_segment.hpp"

namespace splinecast::ipc {
namespace {

std::vector<double> to_vector(std::span<const double> values) {
  return {values.begin(), values.end()};
}

}  // namespace

void SlowedPath::add_knot(const core::Knot& knot) {
  knots_.push_back({.time = knot.time,
                    .waypoint = to_vector(knot.waypoint),
                    .residual = to_vector(knot.residual),
                    .velocity = to_vector(knot.velocity),
                    .given = to_vector(knot.acceleration),
                    .before = before_,
                    .after = before_});
}

void SlowedPath::add(const core::SlidingWindow& target, std::size_t i) {
  add_knot(target.knot(i));
  target.segment(i, piece_);
  core::evaluate_derivative(piece_.order, piece_.coefficients, 0, 2, knots_.back().after);
  core::evaluate_derivative(piece_.order, piece_.coefficients,
                            to_seconds(piece_.right - piece_.left), 2, before_);
}

void SlowedPath::add_last(const core::SlidingWindow& target) {
  add_knot(target.knot(target.knots() - 1));
}

SlowedPath::Slowed SlowedPath::slowed(const core::Slowing& slowing, std::size_t i) const {
  const Knot& knot = knots_[i];
  Slowed out{.time = slowing.time_of(knot.time),
             .velocity = std::vector<double>(knot.velocity.size()),
             .acceleration = std::vector<double>(knot.velocity.size())};
  slowing.write_state(out.time, knot.velocity, knot.before, knot.after, out.velocity,
                      out.acceleration);
  if (i == 0 && !knot.given.empty()) out.acceleration = knot.given;
  return out;
}

void SlowedPath::build(std::size_t i, core::Segment& out) const {
  const core::Slowing slowing(knots_.front().time, knots_.back().time);
  const Slowed left = slowed(slowing, i);
  const Slowed right = slowed(slowing, i + 1);
  const auto end = [](const Knot& knot, const Slowed& state) {
    return core::SegmentEnd{state.time, knot.waypoint, state.velocity, state.acceleration,
                            knot.residual};
  };
  core::build_segment(core::SegmentForm::slowed, end(knots_[i], left), end(knots_[i + 1], right),
                      out);
}

}  // namespace splinecast::ipc
