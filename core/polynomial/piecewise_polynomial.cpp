#include "splinecast/piecewise_polynomial.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "core/polynomial/segment.hpp"

namespace splinecast {
namespace {

std::string in_ns(Time t) { return std::to_string(t.count()) + " ns"; }

}  // namespace

int PiecewisePolynomial::order() const noexcept {
  return orders_.empty() ? kCubicOrder : *std::ranges::max_element(orders_);
}

void PiecewisePolynomial::append(Time left, Time right, int order,
                                 std::span<const double> coefficients) {
  const std::string name = "segment " + std::to_string(segments());
  if (order < 1 || order > kMaxPolynomialOrder) {
    throw std::invalid_argument(name + ": order must be 1 to 16, not " + std::to_string(order));
  }
  if (coefficients.size() != static_cast<std::size_t>(order) * dimensions_) {
    throw std::invalid_argument(name + ": " + std::to_string(coefficients.size()) +
                                " coefficients for order " + std::to_string(order) + " and " +
                                std::to_string(dimensions_) + " dimensions");
  }
  if (!breaks_.empty() && (is_hold() || left != breaks_.back())) {
    throw std::invalid_argument(name + " begins at " + in_ns(left) + ", but the curve " +
                                (is_hold() ? "is a hold at " : "ends at ") + in_ns(breaks_.back()));
  }
  if (right < left || (right == left && !breaks_.empty())) {
    throw std::invalid_argument(name + " ends at " + in_ns(right) + ", not after its start");
  }
  if (breaks_.empty()) breaks_.push_back(left);
  if (right > left) breaks_.push_back(right);
  orders_.push_back(order);
  offsets_.push_back(coefficients_.size());
  coefficients_.insert(coefficients_.end(), coefficients.begin(), coefficients.end());
}

std::span<const double> PiecewisePolynomial::coefficients(std::size_t segment) const noexcept {
  return std::span(coefficients_)
      .subspan(offsets_[segment], static_cast<std::size_t>(orders_[segment]) * dimensions_);
}

std::size_t PiecewisePolynomial::segment_at(Time t) const noexcept {
  const auto right = std::ranges::upper_bound(breaks_, t);
  const auto knots_before = static_cast<std::size_t>(right - breaks_.begin());
  return std::clamp<std::size_t>(knots_before, 1, segments()) - 1;
}

void PiecewisePolynomial::evaluate(Time t, const StateRef& out) const noexcept {
  const std::size_t i = segment_at(t);
  core::evaluate(orders_[i], coefficients(i), to_seconds(t - breaks_[i]), out);
}

void PiecewisePolynomial::derivative(Time t, int r, std::span<double> out) const noexcept {
  const std::size_t i = segment_at(t);
  core::evaluate_derivative(orders_[i], coefficients(i), to_seconds(t - breaks_[i]), r, out);
}

void PiecewisePolynomial::jump(std::size_t segment, int r, std::span<double> out) const noexcept {
  std::ranges::fill(out, 0.0);
  if (segment == 0) return;
  const std::size_t before = segment - 1;
  core::evaluate_derivative(orders_[before], coefficients(before), seconds(before), r, out);
  double factorial = 1;
  for (int k = 2; k <= r; ++k) factorial *= k;
  for (std::size_t d = 0; d < dimensions_; ++d) {
    const double right_hand =
        r < orders_[segment]
            ? factorial * coefficients(segment)[static_cast<std::size_t>(r) * dimensions_ + d]
            : 0;
    out[d] = right_hand - out[d];
  }
}

}  // namespace splinecast
