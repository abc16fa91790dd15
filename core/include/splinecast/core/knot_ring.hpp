#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "splinecast/core/condition.hpp"
#include "splinecast/core/segment.hpp"
#include "splinecast/core/time.hpp"
#include "splinecast/core/tridiagonal.hpp"

namespace splinecast::core {

/// What is kept of one knot: enough to go on solving from it. Spans hold one value per dimension.
struct Knot {
  Time time{};
  double gamma = 0;                  ///< γ of its eliminated row
  std::span<const double> position;  ///< of its waypoint
  std::span<const double> velocity;  ///< as solved so far
  std::span<const double> g;         ///< g of its eliminated row
};

/// The last knots of a C² cubic spline and their elimination prefix, in a ring of fixed capacity.
///
/// The batch solver holds all knots in one, the sliding window the few it can still change; both
/// use the same rows. Knots are numbered from 0 in the order they were pushed. Allocates when
/// made only. Not thread-safe: one thread uses it.
class KnotRing {
 public:
  /// Keeps at least the last `capacity` knots (≥ 2) of `dimensions` values each. `start` is the
  /// condition at knot 0; its values must have been checked (require_values).
  KnotRing(std::size_t dimensions, std::size_t capacity, Condition start);

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] const Condition& start() const noexcept { return start_; }

  /// The newest knot; there must be one.
  [[nodiscard]] std::size_t newest() const noexcept { return size_ - 1; }

  /// Appends a knot and eliminates the row of the one before it: O(D). `time` must be later than
  /// the newest knot's. The new knot's velocity is the start condition's, else 0, until solved.
  void push(Time time, std::span<const double> position) noexcept;

  /// Forgets all knots and takes up again where another ring stood: `first` is the number of the
  /// oldest knot given, and `knots` are consecutive up to the newest one.
  void restore(std::size_t first, std::span<const Knot> knots) noexcept;

  /// Solves the newest knot's velocity from a tail, or from the end condition: O(D).
  void close(Tail tail) noexcept;
  void close(const Condition& end) noexcept;

  /// Back-substitutes from the newest knot down to knot `last` inclusive: O(D) per knot.
  void back_substitute_to(std::size_t last) noexcept;

  [[nodiscard]] Knot knot(std::size_t i) const noexcept;

  /// The interval between knots i and i+1, both of which must still be kept.
  [[nodiscard]] Interval interval(std::size_t i) const noexcept;

 private:
  struct Row {
    Time time{};
    double h = 0;  ///< seconds from this knot to the next, once there is one
    double gamma = 0;
  };
  enum Value : std::size_t { kPosition, kChord, kG, kVelocity, kValues };

  [[nodiscard]] Row& row(std::size_t i) noexcept { return rows_[i & mask_]; }
  [[nodiscard]] const Row& row(std::size_t i) const noexcept { return rows_[i & mask_]; }
  [[nodiscard]] std::span<double> values(std::size_t i, Value which) noexcept;
  [[nodiscard]] std::span<const double> values(std::size_t i, Value which) const noexcept;
  [[nodiscard]] Neighbours neighbours(std::size_t i) const noexcept;
  void place(std::size_t i, Time time, std::span<const double> position) noexcept;
  void measure(std::size_t i) noexcept;
  void eliminate(std::size_t i) noexcept;

  std::size_t dimensions_;
  Condition start_;
  bool halts_at_end_ = false;
  std::size_t mask_;
  std::size_t size_ = 0;
  std::vector<Row> rows_;
  std::vector<double> values_;  ///< [knot & mask][which][dimension]
};

/// Writes the acceleration step at the left knot of interval i: a⁺ − a⁻. At knot 0 it is a⁺ if a
/// hold stands before it (`held_before`), else 0, because nothing stands before.
void write_acceleration_step(const KnotRing& knots, std::size_t i, bool held_before,
                             std::span<double> step) noexcept;

}  // namespace splinecast::core
