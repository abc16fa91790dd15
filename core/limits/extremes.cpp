#include "core/limits/extremes.hpp"

#include <algorithm>
#include <cmath>

namespace splinecast::core {
namespace {

/// Accepted error of an extreme due to an inexact zero, relative to its largest term.
constexpr double kNegligible = 0x1p-55;

struct Ends {
  double from;
  double to;

  [[nodiscard]] bool has_inside(double u) const noexcept { return u > from && u < to; }
};

/// Zeros inside a range, ascending.
struct Zeros {
  std::array<double, kMaxOrder> at;
  int count;

  void add(double u) noexcept { at[static_cast<std::size_t>(count++)] = u; }
};

/// Coefficients of a derivative, lowest power first.
template <int N>
struct Polynomial {
  std::array<double, static_cast<std::size_t>(N)> c;

  /// Evaluates with the operations of `evaluate`.
  [[nodiscard]] double operator()(double u) const noexcept {
    double value = c[N - 1];
    for (std::size_t k = N - 1; k-- > 0;) value = value * u + c[k];
    return value;
  }

  [[nodiscard]] double largest_term(double u) const noexcept {
    double largest = 0;
    double power = 1;
    for (const double term : c) {
      largest = std::max(largest, std::abs(term * power));
      power *= u;
    }
    return largest;
  }
};

/// The m-th derivative of one dimension of a polynomial of order N + m.
template <int N, int M>
Polynomial<N> derivative_of(const double* coefficients, std::size_t dimensions) noexcept {
  Polynomial<N> p{};
  for (int k = 0; k < N; ++k) {
    double factor = 1;
    for (int j = 0; j < M; ++j) factor *= k + M - j;
    p.c[static_cast<std::size_t>(k)] =
        factor * coefficients[static_cast<std::size_t>(k + M) * dimensions];
  }
  return p;
}

/// Adds the zeros of a quadratic, by the stable form: one zero from the sum without cancellation,
/// the other from the product of both. A leading coefficient of 0 makes the first infinite or NaN.
void add_quadratic_zeros(const Polynomial<3>& p, const Ends& ends, Zeros& zeros) noexcept {
  const auto [c, b, a] = p.c;
  const double discriminant = b * b - 4 * a * c;
  if (!(discriminant > 0)) return;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b)) / 2;
  const double first = q / a;
  const double second = c / q;
  const bool is_ascending = first < second;
  for (const double u : {is_ascending ? first : second, is_ascending ? second : first}) {
    if (ends.has_inside(u)) zeros.add(u);
  }
}

struct Place {
  double u;
  double value;
};

/// The zero of a polynomial between two places where its signs differ; it must be monotone between
/// them. Uses Halley's method inside the bracket, and bisects if two steps do not halve the
/// bracket. Stops when the residual times Newton's step is negligible: this bounds the error of the
/// integral at the zero, which is the extreme.
template <int N>
double bracketed_zero(const Polynomial<N>& p, Place low, Place high, double negligible) noexcept {
  constexpr int kTries = 100;
  double width = high.u - low.u;
  double u = low.u + width * (low.value / (low.value - high.value));
  if (!(u > low.u && u < high.u)) u = low.u + width / 2;
  for (int i = 0; i < kTries; ++i) {
    double value = p.c[N - 1];
    double slope = 0;
    double curve = 0;  // half of the second derivative
    for (std::size_t k = N - 1; k-- > 0;) {
      curve = curve * u + slope;
      slope = slope * u + value;
      value = value * u + p.c[k];
    }
    (std::signbit(value) == std::signbit(low.value) ? low : high) = {u, value};
    // The residual times Newton's step.
    if (value * value <= negligible * std::abs(slope)) return u;
    const double next = u - value * slope / (slope * slope - value * curve);
    const bool is_inside = next > low.u && next < high.u;
    const double left = high.u - low.u;
    const bool is_slow = i % 2 == 1 && left > width / 2;
    if (i % 2 == 1) width = left;
    const double try_next = is_inside && !is_slow ? next : low.u + left / 2;
    if (try_next == u) return u;
    u = try_next;
  }
  return u;
}

/// Zeros inside a range of the M-th derivative of a polynomial of order `Order`. `turns` are the
/// zeros of the next derivative, used if there is no closed form.
template <int Order, int M>
Zeros zeros_of(const double* coefficients, std::size_t dimensions, const Ends& ends,
               const Zeros& turns) noexcept {
  constexpr int n = Order - M;
  Zeros zeros{};
  if constexpr (n == 2) {
    const auto p = derivative_of<2, M>(coefficients, dimensions);
    const double u = -p.c[0] / p.c[1];
    if (ends.has_inside(u)) zeros.add(u);
  } else if constexpr (n == 3) {
    add_quadratic_zeros(derivative_of<3, M>(coefficients, dimensions), ends, zeros);
  } else if constexpr (n > 3) {
    const auto p = derivative_of<n, M>(coefficients, dimensions);
    const double most = std::max(std::abs(ends.from), std::abs(ends.to));
    // `largest_term(most) * most / n` is at most the largest term of the previous derivative.
    const double negligible = kNegligible * p.largest_term(most) * most / n;
    Place low{ends.from, p(ends.from)};
    const auto look_until = [&](double u) {
      const Place high{u, p(u)};
      if (std::signbit(low.value) != std::signbit(high.value)) {
        zeros.add(bracketed_zero(p, low, high, negligible));
      }
      low = high;
    };
    for (int i = 0; i < turns.count; ++i) look_until(turns.at[static_cast<std::size_t>(i)]);
    look_until(ends.to);
  }
  return zeros;
}

template <int Order, int M>
SegmentRange range_with(const double* coefficients, std::size_t dimensions, const Ends& ends,
                        const Zeros& turns) noexcept {
  constexpr int n = Order - M;
  if constexpr (n < 1) {
    return {{0, ends.from}, {0, ends.from}};
  } else {
    const auto p = derivative_of<n, M>(coefficients, dimensions);
    const Extreme at_start{p(ends.from), ends.from};
    SegmentRange range{at_start, at_start};
    const auto take = [&](double u) {
      const double value = p(u);
      if (value < range.least.value || std::isnan(value)) range.least = {value, u};
      if (value > range.greatest.value || std::isnan(value)) range.greatest = {value, u};
    };
    for (int i = 0; i < turns.count; ++i) take(turns.at[static_cast<std::size_t>(i)]);
    take(ends.to);
    return range;
  }
}

/// Works from the highest derivative down: the zeros of each derivative are the turning points of
/// the one below it.
template <int Order>
void write_ranges_of(const double* coefficients, std::size_t dimensions, const Ends& ends,
                     Derivatives which, std::array<SegmentRange, 4>& out) noexcept {
  const Zeros none{};
  if (contains(which, Derivatives::jerk)) {
    const Zeros turns = zeros_of<Order, 4>(coefficients, dimensions, ends, none);
    out[3] = range_with<Order, 3>(coefficients, dimensions, ends, turns);
  }
  const Zeros of_jerk = zeros_of<Order, 3>(coefficients, dimensions, ends, none);
  if (contains(which, Derivatives::acceleration)) {
    out[2] = range_with<Order, 2>(coefficients, dimensions, ends, of_jerk);
  }
  const bool has_velocity = contains(which, Derivatives::velocity);
  const bool has_position = contains(which, Derivatives::position);
  if (!has_velocity && !has_position) return;
  const Zeros of_acceleration = zeros_of<Order, 2>(coefficients, dimensions, ends, of_jerk);
  if (has_velocity) {
    out[1] = range_with<Order, 1>(coefficients, dimensions, ends, of_acceleration);
  }
  if (!has_position) return;
  const Zeros of_velocity = zeros_of<Order, 1>(coefficients, dimensions, ends, of_acceleration);
  out[0] = range_with<Order, 0>(coefficients, dimensions, ends, of_velocity);
}

}  // namespace

SegmentPart part_of(const Segment& segment) noexcept {
  return {.order = segment.order,
          .coefficients = segment.coefficients,
          .dimensions = segment.acceleration_step.size(),
          .from = 0,
          .to = to_seconds(segment.right - segment.left)};
}

SegmentRange range_of(int order, std::span<const double> coefficients, std::size_t dimensions,
                      std::size_t d, int derivative, double from, double to) noexcept {
  std::array<SegmentRange, 4> ranges;
  write_ranges({order, coefficients, dimensions, from, to}, d,
               static_cast<Derivatives>(1U << static_cast<unsigned>(derivative)), ranges);
  return ranges[static_cast<std::size_t>(derivative)];
}

void write_ranges(const SegmentPart& part, std::size_t d, Derivatives which,
                  std::array<SegmentRange, 4>& out) noexcept {
  const double* const c = part.coefficients.data() + d;
  const Ends ends{part.from, part.to};
  switch (part.order) {
    case 1:
      return write_ranges_of<1>(c, part.dimensions, ends, which, out);
    case 2:
      return write_ranges_of<2>(c, part.dimensions, ends, which, out);
    case 3:
      return write_ranges_of<3>(c, part.dimensions, ends, which, out);
    case 4:
      return write_ranges_of<4>(c, part.dimensions, ends, which, out);
    case 5:
      return write_ranges_of<5>(c, part.dimensions, ends, which, out);
    default:
      return write_ranges_of<kMaxOrder>(c, part.dimensions, ends, which, out);
  }
}

double size_of_terms(const SegmentPart& part, std::size_t d, int derivative) noexcept {
  const double u = std::max(std::abs(part.from), std::abs(part.to));
  double size = 0;
  double power = 1;
  for (int k = derivative; k < part.order; ++k) {
    double factor = power;
    for (int j = 0; j < derivative; ++j) factor *= k - j;
    const double c = part.coefficients[static_cast<std::size_t>(k) * part.dimensions + d];
    size += std::abs(factor * c);
    power *= u;
  }
  return size;
}

}  // namespace splinecast::core
