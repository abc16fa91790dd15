#include "core/polynomial/segment.hpp"

#include <algorithm>
#include <array>
#include <type_traits>

#include "core/polynomial/cubic.hpp"
#include "core/simd/clones.hpp"
#include "core/simd/lanes.hpp"

namespace splinecast::core {
namespace {

/// Horner's rule for a polynomial and its first three derivatives at once. `Order` is an int, or an
/// integral_constant, for which the loop over powers is unrolled. `finish(velocity, acceleration,
/// jerk)` changes the lanes before they are stored.
template <typename Order, typename Finish>
[[gnu::always_inline]] inline void evaluate_order(Order order, std::size_t dimensions,
                                                  const double* coefficients, double u,
                                                  const StateRef& out,
                                                  const Finish& finish) noexcept {
  const int top = order - 1;
  double* const position_out = out.position.data();
  double* const velocity_out = out.velocity.data();
  double* const acceleration_out = out.acceleration.data();
  double* const jerk_out = out.jerk.data();
  for_overlapping_lanes(dimensions, [&](auto lane, std::size_t first) {
    using Lane = typename decltype(lane)::type;
    const auto coefficient = [&](int power) __attribute__((always_inline)) {
      return load_lane<Lane>(coefficients + static_cast<std::size_t>(power) * dimensions + first);
    };
    const auto factor = [](int product) { return static_cast<double>(product); };
    Lane position = coefficient(top);
    Lane velocity = top >= 1 ? factor(top) * position : Lane{};
    Lane acceleration = top >= 2 ? factor(top * (top - 1)) * position : Lane{};
    Lane jerk = top >= 3 ? factor(top * (top - 1) * (top - 2)) * position : Lane{};
    for (int power = top - 1; power >= 0; --power) {
      const Lane c = coefficient(power);
      position = position * u + c;
      if (power >= 1) velocity = velocity * u + factor(power) * c;
      if (power >= 2) acceleration = acceleration * u + factor(power * (power - 1)) * c;
      if (power >= 3) jerk = jerk * u + factor(power * (power - 1) * (power - 2)) * c;
    }
    finish(velocity, acceleration, jerk);
    store_lane(position_out + first, position);
    store_lane(velocity_out + first, velocity);
    store_lane(acceleration_out + first, acceleration);
    store_lane(jerk_out + first, jerk);
  });
}

template <typename Finish>
[[gnu::always_inline]] inline void evaluate_any(int order, const double* coefficients, double u,
                                                const StateRef& out,
                                                const Finish& finish) noexcept {
  const std::size_t dimensions = out.position.size();
  const double* const c = coefficients;
  if (order == kCubicOrder) {
    evaluate_order(std::integral_constant<int, kCubicOrder>{}, dimensions, c, u, out, finish);
  } else if (order == kMaxOrder) {
    evaluate_order(std::integral_constant<int, kMaxOrder>{}, dimensions, c, u, out, finish);
  } else {
    evaluate_order(order, dimensions, c, u, out, finish);
  }
}

/// The row of coefficients of one power.
std::span<double> power_of(Segment& segment, std::size_t power, std::size_t dimensions) noexcept {
  return std::span<double>(segment.coefficients).subspan(power * dimensions, dimensions);
}

[[gnu::always_inline]] inline void write_cubic(const Interval& i, double* coefficients) noexcept {
  const CubicWriter cubic(i.h, i.x0.size(), coefficients);
  for_overlapping_lanes(i.x0.size(), [&](auto lane, std::size_t first) {
    using Lane = typename decltype(lane)::type;
    (void)cubic.write(first, load_lane<Lane>(i.x0.data() + first),
                      load_lane<Lane>(i.chord.data() + first), load_lane<Lane>(i.v0.data() + first),
                      load_lane<Lane>(i.v1.data() + first));
  });
}

/// The quintic with position, velocity and acceleration given at both ends; does not write c0 and
/// c1.
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

SPLINECAST_VECTOR_CLONES
void evaluate(int order, std::span<const double> coefficients, double u,
              const StateRef& out) noexcept {
  evaluate_any(order, coefficients.data(), u, out, [](auto&, auto&, auto&) {});
}

SPLINECAST_VECTOR_CLONES
void evaluate(int order, std::span<const double> coefficients, double u, const LawRates& law,
              const StateRef& out) noexcept {
  const ChainRule rule(law);
  evaluate_any(
      order, coefficients.data(), u,
      out, [&](auto& velocity, auto& acceleration, auto& jerk) __attribute__((always_inline)) {
        rule.apply(velocity, acceleration, jerk);
      });
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

namespace {

/// The one-sided accelerations of the cubic between two knots, with chord slope m.
template <typename Lane>
[[gnu::always_inline]] inline Lane left_acceleration(const Interval& i, std::size_t d) noexcept {
  const auto m = load_lane<Lane>(i.chord.data() + d);
  const auto v0 = load_lane<Lane>(i.v0.data() + d);
  const auto v1 = load_lane<Lane>(i.v1.data() + d);
  return (6.0 * m - 4.0 * v0 - 2.0 * v1) / i.h;
}
template <typename Lane>
[[gnu::always_inline]] inline Lane right_acceleration(const Interval& i, std::size_t d) noexcept {
  const auto m = load_lane<Lane>(i.chord.data() + d);
  const auto v0 = load_lane<Lane>(i.v0.data() + d);
  const auto v1 = load_lane<Lane>(i.v1.data() + d);
  return (2.0 * v0 + 4.0 * v1 - 6.0 * m) / i.h;
}

}  // namespace

SPLINECAST_VECTOR_CLONES
void write_left_acceleration(const Interval& interval, std::span<double> out) noexcept {
  if (!interval.a0.empty()) {
    std::ranges::copy(interval.a0, out.begin());
    return;
  }
  for_lanes(out.size(), [&](auto lane, std::size_t first) {
    using Lane = typename decltype(lane)::type;
    store_lane<Lane>(out.data() + first, left_acceleration<Lane>(interval, first));
  });
}

SPLINECAST_VECTOR_CLONES
void write_right_acceleration(const Interval& interval, std::span<double> out) noexcept {
  if (!interval.a1.empty()) {
    std::ranges::copy(interval.a1, out.begin());
    return;
  }
  for_lanes(out.size(), [&](auto lane, std::size_t first) {
    using Lane = typename decltype(lane)::type;
    store_lane<Lane>(out.data() + first, right_acceleration<Lane>(interval, first));
  });
}

SPLINECAST_VECTOR_CLONES
void write_acceleration_jump(const Interval& before, const Interval& after,
                             std::span<double> out) noexcept {
  const double* const given_before = before.a1.empty() ? nullptr : before.a1.data();
  const double* const given_after = after.a0.empty() ? nullptr : after.a0.data();
  for_overlapping_lanes(out.size(), [&](auto lane, std::size_t first) {
    using Lane = typename decltype(lane)::type;
    const Lane left = given_before != nullptr ? load_lane<Lane>(given_before + first)
                                              : right_acceleration<Lane>(before, first);
    const Lane right = given_after != nullptr ? load_lane<Lane>(given_after + first)
                                              : left_acceleration<Lane>(after, first);
    store_lane<Lane>(out.data() + first, right - left);
  });
}

SPLINECAST_VECTOR_CLONES
void build_segment(const Interval& interval, Segment& out) noexcept {
  out.left = interval.left;
  out.right = interval.right;
  out.kind = SegmentKind::spline;
  if (interval.a0.empty() && interval.a1.empty()) {
    out.order = kCubicOrder;
    write_cubic(interval, out.coefficients.data());
  } else {
    out.order = kMaxOrder;
    const std::size_t dimensions = interval.x0.size();
    std::ranges::copy(interval.x0, power_of(out, 0, dimensions).begin());
    std::ranges::copy(interval.v0, power_of(out, 1, dimensions).begin());
    write_quintic(interval, out);
  }
}

void build_hold(Time from, Time to, std::span<const double> position, Segment& out) noexcept {
  out.left = from;
  out.right = to;
  out.order = kCubicOrder;
  out.kind = SegmentKind::hold;
  const auto powers = std::span(out.coefficients).first(kCubicOrder * position.size());
  std::ranges::fill(powers, 0.0);
  std::ranges::copy(position, powers.begin());
}

void append(const Segment& segment, PiecewisePolynomial& curve) {
  if (segment.coefficients.size() != static_cast<std::size_t>(kMaxOrder) * curve.dimensions()) {
    throw std::invalid_argument("segment has other dimensions than the curve it is appended to");
  }
  const auto powers = static_cast<std::size_t>(std::clamp(segment.order, 0, kMaxOrder));
  curve.append(segment.left, segment.right, segment.order,
               std::span(segment.coefficients).first(powers * curve.dimensions()));
}

}  // namespace splinecast::core
