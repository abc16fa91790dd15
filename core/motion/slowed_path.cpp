#include "core/motion/slowed_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/forms/knot_segment.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/state.hpp"

namespace splinecast::core {
namespace {

std::vector<double> to_vector(std::span<const double> values) {
  return {values.begin(), values.end()};
}

}  // namespace

bool stays_near(const Slowing& slowing, const Segment& piece, const SegmentPart& path, Time left,
                const PositionRange& range) noexcept {
  constexpr int kLooks = 8;
  constexpr double kNear = 5e-3;
  constexpr double kRounding = 1e-12;
  std::array<double, kMaxDimensions> on_path;
  std::array<double, kMaxDimensions> on_piece;
  const std::size_t dimensions = path.dimensions;
  const Time length = piece.right - piece.left;
  for (int i = 1; i < kLooks; ++i) {
    const Time t = piece.left + length / kLooks * i;
    const double way = slowing.way_at(t) - to_seconds(left - slowing.begin());
    evaluate_derivative(path.order, path.coefficients, way, 0,
                        std::span(on_path).first(dimensions));
    evaluate_derivative(piece.order, piece.coefficients, to_seconds(t - piece.left), 0,
                        std::span(on_piece).first(dimensions));
    for (std::size_t d = 0; d < dimensions; ++d) {
      const double size = range.greatest()[d] - range.least()[d];
      const double most = kNear * size + kRounding * std::abs(on_path[d]);
      if (!(std::abs(on_piece[d] - on_path[d]) <= most)) return false;
    }
  }
  return true;
}

void SlowedPath::add_knot(const Knot& knot) {
  knots_.push_back({.time = knot.time,
                    .waypoint = to_vector(knot.waypoint),
                    .residual = to_vector(knot.residual),
                    .velocity = to_vector(knot.velocity),
                    .given = to_vector(knot.acceleration),
                    .before = before_,
                    .after = before_});
}

void SlowedPath::add(const Knot& knot, const SegmentPart& segment) {
  add_knot(knot);
  evaluate_derivative(segment.order, segment.coefficients, segment.from, 2, knots_.back().after);
  evaluate_derivative(segment.order, segment.coefficients, segment.to, 2, before_);
}

void SlowedPath::add_last(const Knot& knot) { add_knot(knot); }

SlowedPath::Slowed SlowedPath::slowed(const Slowing& slowing, std::size_t i) const {
  const PathKnot& knot = knots_[i];
  Slowed out{.time = slowing.time_of(knot.time),
             .velocity = std::vector<double>(knot.velocity.size()),
             .acceleration = std::vector<double>(knot.velocity.size())};
  slowing.write_state(out.time, knot.velocity, knot.before, knot.after, out.velocity,
                      out.acceleration);
  if (i == 0 && !knot.given.empty()) out.acceleration = knot.given;
  return out;
}

void SlowedPath::build(std::size_t i, Segment& out) const {
  const Slowed left = slowed(slowing(), i);
  const Slowed right = slowed(slowing(), i + 1);
  const auto end = [](const PathKnot& knot, const Slowed& state) {
    return SegmentEnd{state.time, knot.waypoint, state.velocity, state.acceleration, knot.residual};
  };
  build_segment(SegmentForm::slowed, end(knots_[i], left), end(knots_[i + 1], right), out);
}

}  // namespace splinecast::core
