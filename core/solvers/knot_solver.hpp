#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/solvers/knot_ring.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/method.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::core {

/// Computes the knot velocities of one method in the rows of a KnotRing. The batch solver uses it
/// over all knots at once, the sliding window over the knots that an append still changes.
///
/// Holds parameters only: the ring holds the state. No function throws; the functions for online
/// use do not allocate.
class KnotSolver {
 public:
  /// `start` is the condition at knot 0 of the first run.
  KnotSolver(const Condition& start, std::size_t dimensions) : first_start_(start), start_(start) {
    start_.value.reserve(dimensions);
  }
  KnotSolver(const KnotSolver&) = delete;
  KnotSolver& operator=(const KnotSolver&) = delete;
  virtual ~KnotSolver() = default;

  /// Appends a knot to the ring and eliminates the rows that it completes: O(D). The waypoint must
  /// be later than the newest knot and have the values that the method needs.
  virtual void push(KnotRing& knots, const Waypoint& waypoint) const noexcept = 0;

  /// Eliminates all rows again, after a change of the start condition. For the first few knots of a
  /// run.
  virtual void eliminate_again(KnotRing& knots) const noexcept = 0;

  /// Restores the start condition of the constructor.
  void start_as_first() noexcept { start_with(first_start_.kind, first_start_.value); }

  /// Sets the start condition to the default of the method.
  void start_as_given() noexcept { start_with(ConditionKind::own, {}); }

  /// Sets the start condition of the current run, or of the one that begins, to a velocity.
  void start_with(std::span<const double> velocity) noexcept {
    start_with(ConditionKind::velocity, velocity);
  }

  /// Copies the start condition of another solver.
  void start_as(const KnotSolver& other) noexcept {
    start_with(other.start_.kind, other.start_.value);
  }

  /// Solves knots `first` to the newest while the stream continues: O(D) per knot.
  virtual void solve(KnotRing& knots, Tail tail, std::size_t first) const noexcept = 0;

  /// Both: `push`, then `solve` with a tail.
  virtual void append(KnotRing& knots, const Waypoint& waypoint, Tail tail,
                      std::size_t first) const noexcept {
    push(knots, waypoint);
    solve(knots, tail, first);
  }

  /// Solves knots `first` to the newest, with the end condition there.
  virtual void solve(KnotRing& knots, const Condition& end, std::size_t first) const noexcept = 0;

 protected:
  [[nodiscard]] const Condition& start() const noexcept { return start_; }

 private:
  void start_with(ConditionKind kind, std::span<const double> value) noexcept {
    start_.kind = kind;
    start_.value.assign(value.begin(), value.end());
  }

  const Condition first_start_;
  Condition start_;
};

/// The use of a solver.
enum class Use : std::uint8_t {
  online,   ///< knots are added and dropped, and are solved repeatedly
  at_once,  ///< all knots are pushed, then solved once, with an end condition; may allocate
};

/// The solver of a method; `start` is the condition at knot 0. Parameters and values must have been
/// checked, and the method must stream.
[[nodiscard]] std::unique_ptr<KnotSolver> make_knot_solver(const Interpolant& how,
                                                           const Condition& start,
                                                           std::size_t dimensions, Use use);

/// Writes the velocity of a single knot: that of the start condition, else 0.
void solve_lone_knot(KnotRing& knots, const Condition& start) noexcept;

/// Back-substitutes velocities from the newest knot down to `last` inclusive.
void back_substitute_to(KnotRing& knots, std::size_t last) noexcept;

/// Solves the velocity of the newest knot with a boundary condition; the row before it must be
/// eliminated.
void close(KnotRing& knots, const Condition& end) noexcept;
void close(KnotRing& knots, Tail tail) noexcept;

}  // namespace splinecast::core
