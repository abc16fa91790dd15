#include "splinecast/core/piecewise_polynomial.hpp"

#include <algorithm>
#include <stdexcept>

namespace splinecast::core {

int PiecewisePolynomial::order() const noexcept {
  return orders_.empty() ? kCubicOrder : *std::ranges::max_element(orders_);
}

void PiecewisePolynomial::append(const Segment& segment) {
  const bool is_hold = segment.kind == SegmentKind::hold;
  if (segment.coefficients.size() != static_cast<std::size_t>(kMaxOrder) * dimensions_) {
    throw std::invalid_argument("segment has other dimensions than the curve it is appended to");
  }
  const bool fits = breaks_.empty() || (!is_hold && breaks_.back() == segment.left &&
                                        breaks_.size() == orders_.size() + 1);
  if (!fits) throw std::invalid_argument("segment does not begin where the curve ends");
  if (breaks_.empty()) breaks_.push_back(segment.left);
  if (!is_hold) breaks_.push_back(segment.right);
  orders_.push_back(segment.order);
  coefficients_.insert(coefficients_.end(), segment.coefficients.begin(),
                       segment.coefficients.end());
  acceleration_steps_.insert(acceleration_steps_.end(), segment.acceleration_step.begin(),
                             segment.acceleration_step.end());
}

std::span<const double> PiecewisePolynomial::coefficients(std::size_t segment) const noexcept {
  const std::size_t size = static_cast<std::size_t>(kMaxOrder) * dimensions_;
  return std::span(coefficients_).subspan(segment * size, size);
}

std::span<const double> PiecewisePolynomial::acceleration_step(std::size_t segment) const noexcept {
  return std::span(acceleration_steps_).subspan(segment * dimensions_, dimensions_);
}

std::size_t PiecewisePolynomial::segment_at(Time t) const noexcept {
  const auto right = std::ranges::upper_bound(breaks_, t);
  const auto knots_before = static_cast<std::size_t>(right - breaks_.begin());
  return std::clamp<std::size_t>(knots_before, 1, segments()) - 1;
}

void PiecewisePolynomial::evaluate(Time t, StateRef out) const noexcept {
  const std::size_t i = segment_at(t);
  core::evaluate(orders_[i], coefficients(i), to_seconds(t - breaks_[i]), out);
}

}  // namespace splinecast::core
