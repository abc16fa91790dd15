#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "splinecast/core/segment.hpp"

namespace splinecast::core {

/// A curve of consecutive segments with D dimensions: n breaks, n − 1 pieces of order 4 or 6, each
/// local to its left break (doc 003 §4.4, there MGPPRep). Not thread-safe while it is appended to.
class PiecewisePolynomial {
 public:
  explicit PiecewisePolynomial(std::size_t dimensions) : dimensions_(dimensions) {}

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }
  [[nodiscard]] std::size_t segments() const noexcept { return orders_.size(); }

  /// Highest order of its segments; 4 if it has none.
  [[nodiscard]] int order() const noexcept;

  /// Appends a segment that begins where the last one ends. A hold of no length stands alone.
  /// Throws std::invalid_argument if it does not fit.
  void append(const Segment& segment);

  /// Times of the breaks: segments() + 1 of them; one if it is a hold; none if empty.
  [[nodiscard]] std::span<const Time> breaks() const noexcept { return breaks_; }

  [[nodiscard]] int order_of(std::size_t segment) const noexcept { return orders_[segment]; }

  /// kMaxOrder·D coefficients of a segment, [power][dimension], lowest power first.
  [[nodiscard]] std::span<const double> coefficients(std::size_t segment) const noexcept;

  /// Acceleration step at the left break of a segment, per dimension.
  [[nodiscard]] std::span<const double> acceleration_step(std::size_t segment) const noexcept;

  /// The segment that a time between the first and the last break belongs to. A time on a break
  /// belongs to the segment on its right, the last break to the one on its left. O(log n).
  [[nodiscard]] std::size_t segment_at(Time t) const noexcept;

  /// Evaluates at a time between the first and the last break. O(log n + order·D).
  void evaluate(Time t, StateRef out) const noexcept;

 private:
  std::size_t dimensions_;
  std::vector<Time> breaks_;
  std::vector<int> orders_;
  std::vector<double> coefficients_;
  std::vector<double> acceleration_steps_;
};

}  // namespace splinecast::core
