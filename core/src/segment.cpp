#include "splinecast/core/segment.hpp"

#include <algorithm>
#include <array>
#include <type_traits>

namespace splinecast::core {
namespace {

/// Horner's rule for a polynomial and its first three derivatives at once. `Order` is an int, or an
/// integral_constant, for which the loop over powers is unrolled.
template <typename Order>
void evaluate_order(Order order, std::size_t dimensions, const double* __restrict c, double u,
                    double* __restrict p, double* __restrict v, double* __restrict a,
                    double* __restrict j) noexcept {
  const int top = order - 1;
  for (std::size_t d = 0; d < dimensions; ++d) {
    double position = c[static_cast<std::size_t>(top) * dimensions + d];
    double velocity = top >= 1 ? top * position : 0;
    double acceleration = top >= 2 ? top * (top - 1) * position : 0;
    double jerk = top >= 3 ? top * (top - 1) * (top - 2) * position : 0;
    for (int power = top - 1; power >= 0; --power) {
      const double coefficient = c[static_cast<std::size_t>(power) * dimensions + d];
      position = position * u + coefficient;
      if (power >= 1) velocity = velocity * u + power * coefficient;
      if (power >= 2) acceleration = acceleration * u + power * (power - 1) * coefficient;
      if (power >= 3) jerk = jerk * u + power * (power - 1) * (power - 2) * coefficient;
    }
    p[d] = position;
    v[d] = velocity;
    a[d] = acceleration;
    j[d] = jerk;
  }
}

/// The row of coefficients of one power.
std::span<double> power_of(Segment& segment, std::size_t power, std::size_t dimensions) noexcept {
  return std::span<double>(segment.coefficients).subspan(power * dimensions, dimensions);
}

void write_cubic(const Interval& i, Segment& out) noexcept {
  const std::size_t dimensions = i.x0.size();
  const double per_h = 1 / i.h;
  const double per_h2 = per_h * per_h;
  const double* __restrict const m = i.chord.data();
  const double* __restrict const v0 = i.v0.data();
  const double* __restrict const v1 = i.v1.data();
  double* __restrict const c2 = power_of(out, 2, dimensions).data();
  double* __restrict const c3 = power_of(out, 3, dimensions).data();
  for (std::size_t d = 0; d < dimensions; ++d) {
    c2[d] = (3 * m[d] - 2 * v0[d] - v1[d]) * per_h;
    c3[d] = (v0[d] + v1[d] - 2 * m[d]) * per_h2;
  }
}

/// The quintic with position, velocity and acceleration given at both ends; c0 and c1 stand.
void write_quintic(const Interval& i, Segment& out) noexcept {
  const std::size_t dimensions = i.x0.size();
  const double h = i.h;
  const double per_2h2 = 1 / (2 * h * h);
  const double per_2h3 = per_2h2 / h;
  const double per_2h4 = per_2h3 / h;
  const auto c2 = power_of(out, 2, dimensions);
  const auto c3 = power_of(out, 3, dimensions);
  const auto c4 = power_of(out, 4, dimensions);
  const auto c5 = power_of(out, 5, dimensions);
  std::array<double, kMaxDimensions> left{};
  std::array<double, kMaxDimensions> right{};
  write_left_acceleration(i, std::span(left).first(dimensions));
  write_right_acceleration(i, std::span(right).first(dimensions));
  for (std::size_t d = 0; d < dimensions; ++d) {
    const double m = i.chord[d];
    const double v0 = i.v0[d];
    const double v1 = i.v1[d];
    const double a0 = left[d];
    const double a1 = right[d];
    c2[d] = a0 / 2;
    c3[d] = (20 * m - 12 * v0 - 8 * v1 - (3 * a0 - a1) * h) * per_2h2;
    c4[d] = (-30 * m + 16 * v0 + 14 * v1 + (3 * a0 - 2 * a1) * h) * per_2h3;
    c5[d] = (12 * m - 6 * (v0 + v1) - (a0 - a1) * h) * per_2h4;
  }
}

}  // namespace

void evaluate(int order, std::span<const double> coefficients, double u,
              const StateRef& out) noexcept {
  const auto evaluate_as = [&](auto any_order) {
    evaluate_order(any_order, out.position.size(), coefficients.data(), u, out.position.data(),
                   out.velocity.data(), out.acceleration.data(), out.jerk.data());
  };
  if (order == kCubicOrder) {
    evaluate_as(std::integral_constant<int, kCubicOrder>{});
  } else if (order == kMaxOrder) {
    evaluate_as(std::integral_constant<int, kMaxOrder>{});
  } else {
    evaluate_as(order);
  }
}

void evaluate_derivative(int order, std::span<const double> coefficients, double u, int derivative,
                         std::span<double> out) noexcept {
  if (order <= derivative) std::ranges::fill(out, 0.0);
  for (int power = order - 1; power >= derivative; --power) {
    double factor = 1;  // exact: 15! < 2^53
    for (int k = 0; k < derivative; ++k) factor *= power - k;
    const double* row = coefficients.data() + static_cast<std::size_t>(power) * out.size();
    for (std::size_t d = 0; d < out.size(); ++d) {
      const double term = factor * row[d];
      out[d] = power == order - 1 ? term : out[d] * u + term;
    }
  }
}

void write_left_acceleration(const Interval& interval, std::span<double> out) noexcept {
  if (!interval.a0.empty()) {
    std::ranges::copy(interval.a0, out.begin());
    return;
  }
  const double h = interval.h;
  const double* __restrict const m = interval.chord.data();
  const double* __restrict const v0 = interval.v0.data();
  const double* __restrict const v1 = interval.v1.data();
  double* __restrict const a = out.data();
  for (std::size_t d = 0; d < out.size(); ++d) a[d] = (6 * m[d] - 4 * v0[d] - 2 * v1[d]) / h;
}

void write_right_acceleration(const Interval& interval, std::span<double> out) noexcept {
  if (!interval.a1.empty()) {
    std::ranges::copy(interval.a1, out.begin());
    return;
  }
  const double h = interval.h;
  const double* __restrict const m = interval.chord.data();
  const double* __restrict const v0 = interval.v0.data();
  const double* __restrict const v1 = interval.v1.data();
  double* __restrict const a = out.data();
  for (std::size_t d = 0; d < out.size(); ++d) a[d] = (2 * v0[d] + 4 * v1[d] - 6 * m[d]) / h;
}

void build_segment(const Interval& interval, Segment& out) noexcept {
  const std::size_t dimensions = interval.x0.size();
  out.left = interval.left;
  out.right = interval.right;
  out.kind = SegmentKind::spline;
  std::ranges::copy(interval.x0, power_of(out, 0, dimensions).begin());
  std::ranges::copy(interval.v0, power_of(out, 1, dimensions).begin());
  if (interval.a0.empty() && interval.a1.empty()) {
    out.order = kCubicOrder;
    write_cubic(interval, out);
    std::ranges::fill(std::span(out.coefficients).subspan(kCubicOrder * dimensions), 0.0);
  } else {
    out.order = kMaxOrder;
    write_quintic(interval, out);
  }
}

void build_stop_tail(Time from, Time stop_time, std::span<const double> position,
                     std::span<const double> velocity, std::span<const double> acceleration,
                     Segment& out) noexcept {
  const std::size_t dimensions = position.size();
  const double rest_after = to_seconds(stop_time);
  out.left = from;
  out.right = from + stop_time;
  out.order = kMaxOrder;
  out.kind = SegmentKind::stop_tail;
  std::ranges::copy(position, power_of(out, 0, dimensions).begin());
  std::ranges::copy(velocity, power_of(out, 1, dimensions).begin());
  const auto c2 = power_of(out, 2, dimensions);
  const auto c3 = power_of(out, 3, dimensions);
  const auto c4 = power_of(out, 4, dimensions);
  for (std::size_t d = 0; d < dimensions; ++d) {
    const double jerk_scale = velocity[d] / (rest_after * rest_after);
    const double snap_scale = acceleration[d] / rest_after;
    c2[d] = acceleration[d] / 2;
    c3[d] = -jerk_scale - 2 * snap_scale / 3;
    c4[d] = (2 * jerk_scale + snap_scale) / (4 * rest_after);
  }
  std::ranges::fill(power_of(out, 5, dimensions), 0.0);
}

void build_hold(Time from, Time to, std::span<const double> position, Segment& out) noexcept {
  out.left = from;
  out.right = to;
  out.order = kCubicOrder;
  out.kind = SegmentKind::hold;
  std::ranges::fill(out.coefficients, 0.0);
  std::ranges::copy(position, power_of(out, 0, position.size()).begin());
}

}  // namespace splinecast::core
