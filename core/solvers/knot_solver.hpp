#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/solvers/knot_ring.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/method.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::core {

/// Finds the knot velocities of one method, in the rows of a KnotRing: the batch solver over all
/// knots at once, the sliding window over those that an append still changes.
///
/// Holds parameters only: the ring carries the state. No function throws, and none that is for
/// online use allocates.
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
  /// be later than the newest knot and carry what the method needs.
  virtual void push(KnotRing& knots, const Waypoint& waypoint) const noexcept = 0;

  /// Eliminates again all rows that stand: knot 0 has got another start condition. For the few
  /// knots that a run begins with.
  virtual void eliminate_again(KnotRing& knots) const noexcept = 0;

  /// Takes the start condition again that it was made with.
  void start_as_first() noexcept { start_with(first_start_.kind, first_start_.value); }

  /// Makes what the method itself does the start condition.
  void start_as_given() noexcept { start_with(ConditionKind::own, {}); }

  /// Makes a velocity the start condition of the run that stands, or begins.
  void start_with(std::span<const double> velocity) noexcept {
    start_with(ConditionKind::velocity, velocity);
  }

  /// Takes the start condition of another solver.
  void start_as(const KnotSolver& other) noexcept {
    start_with(other.start_.kind, other.start_.value);
  }

  /// Solves knots `first` to the newest while the stream goes on: O(D) per knot.
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

/// What a solver is for.
enum class Use : std::uint8_t {
  online,   ///< knots come and go, and are solved again and again
  at_once,  ///< all knots are pushed, then solved once, with an end condition; may allocate
};

/// The solver of a method; `start` is the condition at knot 0. Parameters and values must have been
/// checked, and the method must stream.
[[nodiscard]] std::unique_ptr<KnotSolver> make_knot_solver(const Interpolant& how,
                                                           const Condition& start,
                                                           std::size_t dimensions, Use use);

/// Writes what the velocity of a lone knot is: the start condition's, else 0.
void solve_lone_knot(KnotRing& knots, const Condition& start) noexcept;

/// Back-substitutes velocities from the newest knot down to `last` inclusive.
void back_substitute_to(KnotRing& knots, std::size_t last) noexcept;

/// Solves the newest knot's velocity with a condition or a tail; the row before it is eliminated.
void close(KnotRing& knots, const Condition& end) noexcept;
void close(KnotRing& knots, Tail tail) noexcept;

}  // namespace splinecast::core
