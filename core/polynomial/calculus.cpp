#include "splinecast/calculus.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/polynomial/segment.hpp"

namespace splinecast {
namespace {

std::string in_ns(Time t) { return std::to_string(t.count()) + " ns"; }

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
