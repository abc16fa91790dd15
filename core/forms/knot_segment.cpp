#include "core/forms/knot_segment.hpp"

#include <algorithm>
#include <array>

#include "core/forms/chord.hpp"
#include "core/forms/entry.hpp"
#include "core/forms/stop.hpp"
#include "core/polynomial/cubic.hpp"
#include "core/simd/clones.hpp"
#include "core/simd/lanes.hpp"
#include "splinecast/state.hpp"

namespace splinecast::core {
namespace {

constexpr std::array<double, kMaxDimensions> kZeros{};

/// The interval between two knots, with the memory that its views refer to.
struct Between {
  std::array<double, kMaxDimensions> chord;
  std::array<double, kMaxDimensions> position;
  Interval interval;

  // NOLINTNEXTLINE(*-member-init): the arrays are written before they are read
  Between(SegmentForm form, const SegmentEnd& left, const SegmentEnd& right) noexcept {
    const std::size_t dimensions = left.waypoint.size();
    const auto m = std::span(chord).first(dimensions);
    interval = {.left = left.time,
                .right = right.time,
                .h = to_seconds(right.time - left.time),
                .x0 = left.waypoint,
                .chord = m,
                .v0 = left.velocity,
                .v1 = right.velocity,
                .a0 = {},
                .a1 = {}};
    write_chord(left.waypoint, right.waypoint, interval.h, m);
    if (!left.residual.empty()) {
      for (std::size_t d = 0; d < dimensions; ++d) {
        m[d] = smoothed_chord(m[d], interval.h, left.residual[d], right.residual[d]);
      }
      interval.x0 = std::span(position).first(dimensions);
      write_position(left, std::span(position).first(dimensions));
    }
    give_accelerations(form, left, right);
  }

 private:
  void give_accelerations(SegmentForm form, const SegmentEnd& left,
                          const SegmentEnd& right) noexcept {
    const auto zeros = std::span(kZeros).first(left.waypoint.size());
    if (form == SegmentForm::quintic) {
      interval.a0 = left.acceleration;
      interval.a1 = right.acceleration;
    }
    if (form == SegmentForm::halt_left || form == SegmentForm::halt_both) interval.a0 = zeros;
    if (form == SegmentForm::halt_right || form == SegmentForm::halt_both) interval.a1 = zeros;
  }
};

}  // namespace

void write_position(const SegmentEnd& knot, std::span<double> position) noexcept {
  std::ranges::copy(knot.waypoint, position.begin());
  for (std::size_t d = 0; d < knot.residual.size(); ++d) {
    position[d] = knot.waypoint[d] - knot.residual[d];
  }
}

SPLINECAST_VECTOR_CLONES
double build_cubic(const CubicEnds& ends, Segment& out) noexcept {
  const double h = to_seconds(ends.right - ends.left);
  const std::size_t dimensions = out.acceleration_step.size();
  const CubicWriter cubic(h, dimensions, out.coefficients.data());
  out.left = ends.left;
  out.right = ends.right;
  out.kind = SegmentKind::spline;
  out.order = kCubicOrder;
  double sum = 0;
  for_overlapping_lanes(dimensions, [&](auto lane, std::size_t first) {
    using Lane = typename decltype(lane)::type;
    const auto x0 = load_lane<Lane>(ends.left_position + first);
    const auto x1 = load_lane<Lane>(ends.right_position + first);
    const Lane written =
        cubic.write(first, x0, chord_slope(x0, x1, h), load_lane<Lane>(ends.left_velocity + first),
                    load_lane<Lane>(ends.right_velocity + first));
    sum += sum_of_lane(written);
  });
  return sum;
}

void build_segment(SegmentForm form, const SegmentEnd& left, const SegmentEnd& right,
                   Segment& out) noexcept {
  if (form == SegmentForm::cubic && left.residual.empty()) {
    (void)build_cubic({.left = left.time,
                       .right = right.time,
                       .left_position = left.waypoint.data(),
                       .right_position = right.waypoint.data(),
                       .left_velocity = left.velocity.data(),
                       .right_velocity = right.velocity.data()},
                      out);
    return;
  }
  const bool is_between_knots = form != SegmentForm::entry && form != SegmentForm::stop &&
                                form != SegmentForm::hold && form != SegmentForm::slowed;
  if (is_between_knots) return build_segment(Between(form, left, right).interval, out);
  std::array<double, kMaxDimensions> from_values;  // NOLINT(*-member-init)
  const auto from = std::span(from_values).first(left.waypoint.size());
  write_position(left, from);
  if (form == SegmentForm::hold) return build_hold(left.time, right.time, from, out);
  if (form == SegmentForm::stop) {
    return build_stop(left.time, right.time - left.time, from, left.velocity, left.acceleration,
                      out);
  }
  std::array<double, kMaxDimensions> to_values;  // NOLINT(*-member-init)
  const auto to = std::span(to_values).first(left.waypoint.size());
  write_position(right, to);
  build_entry({left.time, from, left.velocity, left.acceleration},
              {right.time, to, right.velocity, right.acceleration}, out);
  if (form == SegmentForm::slowed) out.kind = SegmentKind::slowed;
}

void write_end_accelerations(SegmentForm form, const SegmentEnd& left, const SegmentEnd& right,
                             std::span<double> start, std::span<double> end) noexcept {
  std::ranges::fill(start, 0.0);
  std::ranges::fill(end, 0.0);
  if (form == SegmentForm::hold) return;
  if (form == SegmentForm::stop) {
    const double seconds = to_seconds(right.time - left.time);
    for (std::size_t d = 0; d < start.size(); ++d) {
      start[d] = stop_acceleration(left.velocity[d], left.acceleration[d], seconds);
    }
    return;
  }
  if (starts_with_acceleration(form)) std::ranges::copy(left.acceleration, start.begin());
  if (arrives_with_acceleration(form)) {
    std::ranges::copy(right.acceleration, end.begin());
    return;
  }
  const Between between(form, left, right);
  write_left_acceleration(between.interval, start);
  write_right_acceleration(between.interval, end);
}

}  // namespace splinecast::core
