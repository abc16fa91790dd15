#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "splinecast/core/knot_ring.hpp"
#include "splinecast/core/splice.hpp"

namespace splinecast::core {

/// A waypoint that stands before a run: its time and position.
struct StandingWaypoint {
  Time time{};
  std::span<const double> position;
};

/// The velocity at the first knot of a run that replaces another curve: the slope there of the
/// parabola through the first three waypoints; while fewer are known, the ones that stand before
/// the run count too. It comes from waypoints alone, never from the curve. Allocates when made
/// only. Not thread-safe: one thread uses it.
class RunBeginning {
 public:
  explicit RunBeginning(std::size_t dimensions);

  /// Takes the waypoints that stand before the run, oldest first: the last two count.
  void begin(std::span<const StandingWaypoint> before) noexcept;

  /// Finds the velocity of knot 0 from the waypoints around it, and tells the knots of the one
  /// before.
  void update(KnotRing& knots) noexcept;

  /// The velocity of knot 0 that `update` has found.
  [[nodiscard]] std::span<const double> velocity() const noexcept { return values(kKnotVelocity); }

 private:
  enum Value : std::size_t {
    kKnotVelocity,
    kBefore,   ///< position of the waypoint before knot 0
    kBefore2,  ///< and of the one before that
    kChord,
    kChord2,
    kValues
  };
  [[nodiscard]] std::span<double> values(Value which) noexcept {
    return std::span(values_).subspan(which * dimensions_, dimensions_);
  }
  [[nodiscard]] std::span<const double> values(Value which) const noexcept {
    return std::span(values_).subspan(which * dimensions_, dimensions_);
  }

  std::size_t dimensions_;
  std::size_t standing_ = 0;  ///< waypoints before, at most two
  Time before_{};
  Time before2_{};
  double h_before_ = 0;  ///< seconds from the waypoint before knot 0 to it, once it has come
  std::vector<double> values_;
};

}  // namespace splinecast::core
