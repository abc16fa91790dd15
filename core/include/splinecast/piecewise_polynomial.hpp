#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// Coefficients per dimension of what is fitted or published: 4 for a cubic, 6 for `quintic`,
/// entries, halts and stops.
inline constexpr int kCubicOrder = 4;
inline constexpr int kMaxOrder = 6;

/// Highest order of a segment of a PiecewisePolynomial. It is above kMaxOrder, so that a curve can
/// be integrated and raised, or made of a B-spline or Bézier segments of a higher degree.
inline constexpr int kMaxPolynomialOrder = 16;

/// What a segment is for; readers derive a sample's status from it.
enum class SegmentKind : std::uint8_t {
  spline = 0,     ///< between two waypoints
  splice = 1,     ///< entry: of order 6, from a given state
  stop_tail = 2,  ///< stop segment: behind the newest knot, ends at rest
  hold = 3,       ///< at rest: between a stop segment and an entry, or, of no length, the one
                  ///< waypoint of a finished stream
};

/// A curve of consecutive segments with D dimensions: n breaks, n − 1 polynomials of any order k
/// from 1 to kMaxPolynomialOrder, each local to its left break. One segment of no length may stand
/// alone: the hold of a single waypoint.
///
/// Not thread-safe while it is appended to. A function that is given a segment's number needs
/// segment < segments(), one that is given a time a curve that is not empty.
class PiecewisePolynomial {
 public:
  explicit PiecewisePolynomial(std::size_t dimensions) : dimensions_(dimensions) {}

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }
  [[nodiscard]] std::size_t segments() const noexcept { return orders_.size(); }

  /// Whether it is one segment of no length.
  [[nodiscard]] bool is_hold() const noexcept { return breaks_.size() == 1; }

  /// Highest order of its segments; 4 if it has none.
  [[nodiscard]] int order() const noexcept;

  /// Appends a polynomial of order·D coefficients, [power][dimension], lowest power first, in
  /// seconds from `left`. Throws std::invalid_argument, with the values, for an order out of range,
  /// another number of coefficients, a segment that does not begin where the last one ends or that
  /// ends before it begins, and for one of no length that would not stand alone.
  void append(Time left, Time right, int order, std::span<const double> coefficients);

  /// Times of the breaks: segments() + 1 of them; one if it is a hold; none if empty.
  [[nodiscard]] std::span<const Time> breaks() const noexcept { return breaks_; }

  [[nodiscard]] int order_of(std::size_t segment) const noexcept { return orders_[segment]; }
  [[nodiscard]] Time left_of(std::size_t segment) const noexcept { return breaks_[segment]; }
  [[nodiscard]] Time right_of(std::size_t segment) const noexcept {
    return is_hold() ? breaks_.front() : breaks_[segment + 1];
  }

  /// Length of a segment in seconds.
  [[nodiscard]] double seconds(std::size_t segment) const noexcept {
    return to_seconds(right_of(segment) - left_of(segment));
  }

  /// order_of(segment)·D coefficients of a segment, [power][dimension], lowest power first.
  [[nodiscard]] std::span<const double> coefficients(std::size_t segment) const noexcept;

  /// The segment that a time between the first and the last break belongs to. A time on a break
  /// belongs to the segment on its right, the last break to the one on its left. O(log n).
  [[nodiscard]] std::size_t segment_at(Time t) const noexcept;

  /// Evaluates at a time between the first and the last break. O(log n + order·D).
  void evaluate(Time t, const StateRef& out) const noexcept;

  /// Evaluates the r-th derivative, r ≥ 0, at a time between the first and the last break: D
  /// values, for r ≤ 3 those of `evaluate` to the bit. O(log n + order·D).
  void derivative(Time t, int r, std::span<double> out) const noexcept;

  /// Writes by how much the r-th derivative, r ≥ 0, jumps at the left break of a segment: D values,
  /// right-hand minus left-hand; 0 at the first break. O(order·D).
  void jump(std::size_t segment, int r, std::span<double> out) const noexcept;

 private:
  std::size_t dimensions_;
  std::vector<Time> breaks_;
  std::vector<int> orders_;
  std::vector<std::size_t> offsets_;  ///< where each segment's coefficients begin
  std::vector<double> coefficients_;
};

}  // namespace splinecast
