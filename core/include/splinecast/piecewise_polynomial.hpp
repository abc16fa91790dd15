#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// Orders (coefficients per dimension) of fitted and published segments: 4 for a cubic, 6 for
/// `quintic`, entries, full stops and stop segments.
inline constexpr int kCubicOrder = 4;
inline constexpr int kMaxOrder = 6;

/// Highest order of a segment of a PiecewisePolynomial. It is above kMaxOrder, so that a curve can
/// be integrated and raised.
inline constexpr int kMaxPolynomialOrder = 16;

/// The purpose of a segment; readers derive the status of a sample from it.
enum class SegmentKind : std::uint8_t {
  spline = 0,  ///< between two waypoints
  entry = 1,   ///< order 6, from a given state onto the waypoints
  stop = 2,    ///< after the newest knot, ends at rest
  hold = 3,    ///< at rest: between a stop segment and an entry; or, with zero length, the only
               ///< waypoint of a finished stream
  slowed = 4,  ///< order 6, between two waypoints of a path on which the curve comes to rest
};

/// A curve of consecutive segments with D dimensions: n breaks, n − 1 polynomials of any order k
/// from 1 to kMaxPolynomialOrder, each local to its left break. A segment of zero length must be
/// the only one: the hold of a single waypoint.
///
/// Not thread-safe while a thread appends. A function with a segment index requires segment <
/// segments(); a function with a time requires a non-empty curve.
class PiecewisePolynomial {
 public:
  explicit PiecewisePolynomial(std::size_t dimensions) : dimensions_(dimensions) {}

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }
  [[nodiscard]] std::size_t segments() const noexcept { return orders_.size(); }

  /// Whether it is a single segment of zero length.
  [[nodiscard]] bool is_hold() const noexcept { return breaks_.size() == 1; }

  /// Highest order of its segments; 4 if it has none.
  [[nodiscard]] int order() const noexcept;

  /// Appends a polynomial of order·D coefficients, [power][dimension], lowest power first, in
  /// seconds from `left`. Throws std::invalid_argument, with the values, for an order out of range,
  /// a wrong number of coefficients, a segment that does not begin at the end of the last one or
  /// that ends before it begins, and a segment of zero length that would not be the only one.
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

  /// The segment to which a time between the first and the last break belongs. A time on a break
  /// belongs to the segment on its right, the last break to the segment on its left. O(log n).
  [[nodiscard]] std::size_t segment_at(Time t) const noexcept;

  /// Evaluates at a time between the first and the last break. O(log n + order·D).
  void evaluate(Time t, const StateRef& out) const noexcept;

  /// Evaluates the r-th derivative, r ≥ 0, at a time between the first and the last break: D
  /// values, for r ≤ 3 with the bits of `evaluate`. O(log n + order·D).
  void derivative(Time t, int r, std::span<double> out) const noexcept;

  /// Writes the jump of the r-th derivative, r ≥ 0, at the left break of a segment: D values,
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
