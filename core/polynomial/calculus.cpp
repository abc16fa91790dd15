#include "splinecast/calculus.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/polynomial/segment.hpp"

namespace splinecast {
namespace {

std::string in_ns(Time t) { return std::to_string(t.count()) + " ns"; }

void append_all(PiecewisePolynomial& to, const PiecewisePolynomial& curve, Time later = Time(0)) {
  for (std::size_t i = 0; i < curve.segments(); ++i) {
    to.append(curve.left_of(i) + later, curve.right_of(i) + later, curve.order_of(i),
              curve.coefficients(i));
  }
}

/// Re-expands a polynomial about s: repeated synthetic division by (u − s).
void shift_expansion(std::span<double> coefficients, std::size_t dimensions, double s) {
  const std::size_t size = coefficients.size();
  for (std::size_t done = 0; done + dimensions < size; done += dimensions) {
    for (std::size_t k = size - dimensions; k-- > done;) {
      coefficients[k] += s * coefficients[k + dimensions];
    }
  }
}

void require_range(const PiecewisePolynomial& curve, Time from, Time to) {
  if (curve.segments() == 0) throw std::invalid_argument("an empty curve has no part");
  const Time first = curve.breaks().front();
  const Time last = curve.breaks().back();
  if (first <= from && from <= to && to <= last) return;
  throw std::invalid_argument("no part from " + in_ns(from) + " to " + in_ns(to) +
                              " of a curve from " + in_ns(first) + " to " + in_ns(last));
}

}  // namespace

PiecewisePolynomial differentiated(const PiecewisePolynomial& curve) {
  const std::size_t dimensions = curve.dimensions();
  PiecewisePolynomial result(dimensions);
  for (std::size_t i = 0; i < curve.segments(); ++i) {
    const auto c = curve.coefficients(i);
    const int order = std::max(curve.order_of(i) - 1, 1);
    std::vector<double> slopes(static_cast<std::size_t>(order) * dimensions);
    for (std::size_t k = dimensions; k < c.size(); ++k) {
      const std::size_t power = k / dimensions;
      slopes[k - dimensions] = static_cast<double>(power) * c[k];
    }
    result.append(curve.left_of(i), curve.right_of(i), order, slopes);
  }
  return result;
}

PiecewisePolynomial integrated(const PiecewisePolynomial& curve) {
  const std::size_t dimensions = curve.dimensions();
  PiecewisePolynomial result(dimensions);
  std::vector<double> area(dimensions);  // up to the segment
  for (std::size_t i = 0; i < curve.segments(); ++i) {
    const auto c = curve.coefficients(i);
    const int order = curve.order_of(i) + 1;
    std::vector<double> sums(area);
    for (std::size_t k = 0; k < c.size(); ++k) {
      const std::size_t power = k / dimensions + 1;
      sums.push_back(c[k] / static_cast<double>(power));
    }
    result.append(curve.left_of(i), curve.right_of(i), order, sums);
    core::evaluate_derivative(order, sums, curve.seconds(i), 0, area);
  }
  return result;
}

PiecewisePolynomial restricted(const PiecewisePolynomial& curve, Time from, Time to) {
  require_range(curve, from, to);
  PiecewisePolynomial result(curve.dimensions());
  for (std::size_t i = curve.segment_at(from); i < curve.segments(); ++i) {
    const Time left = std::max(from, curve.left_of(i));
    const Time right = std::min(to, curve.right_of(i));
    std::vector<double> c(curve.coefficients(i).begin(), curve.coefficients(i).end());
    if (left > curve.left_of(i)) {
      shift_expansion(c, curve.dimensions(), to_seconds(left - curve.left_of(i)));
    }
    result.append(left, right, curve.order_of(i), c);
    if (right == to) break;
  }
  return result;
}

PiecewisePolynomial concatenated(const PiecewisePolynomial& a, const PiecewisePolynomial& b) {
  if (a.dimensions() != b.dimensions()) {
    throw std::invalid_argument("a curve of " + std::to_string(a.dimensions()) +
                                " dimensions cannot be followed by one of " +
                                std::to_string(b.dimensions()));
  }
  if (a.segments() == 0) return b;
  if (b.segments() == 0) return a;
  if (a.breaks().back() != b.breaks().front()) {
    throw std::invalid_argument("a curve that ends at " + in_ns(a.breaks().back()) +
                                " cannot be followed by one that begins at " +
                                in_ns(b.breaks().front()));
  }
  if (a.is_hold()) return b;
  if (b.is_hold()) return a;
  PiecewisePolynomial result = a;
  append_all(result, b);
  return result;
}

PiecewisePolynomial shifted(const PiecewisePolynomial& curve, Time by) {
  PiecewisePolynomial result(curve.dimensions());
  append_all(result, curve, by);
  return result;
}

PiecewisePolynomial raised(const PiecewisePolynomial& curve, int order) {
  PiecewisePolynomial result(curve.dimensions());
  for (std::size_t i = 0; i < curve.segments(); ++i) {
    if (order < curve.order_of(i) || order > kMaxPolynomialOrder) {
      throw std::invalid_argument("segment " + std::to_string(i) + " of order " +
                                  std::to_string(curve.order_of(i)) +
                                  " cannot be raised to order " + std::to_string(order));
    }
    std::vector<double> c(curve.coefficients(i).begin(), curve.coefficients(i).end());
    c.resize(static_cast<std::size_t>(order) * curve.dimensions());
    result.append(curve.left_of(i), curve.right_of(i), order, c);
  }
  return result;
}

}  // namespace splinecast
