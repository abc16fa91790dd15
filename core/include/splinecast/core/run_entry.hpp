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

/// How a run of knots begins that is entered from a given state: the state, what the waypoints
/// before it say of the first knot, and the splice between them. Allocates when made only. Not
/// thread-safe: one thread uses it.
class RunEntry {
 public:
  explicit RunEntry(std::size_t dimensions);

  /// Takes a state to go on from, and the waypoints that stand before it, oldest first: the last
  /// two count.
  void begin(const Instant& from, std::span<const StandingWaypoint> before) noexcept;

  [[nodiscard]] Time time() const noexcept { return time_; }

  /// Finds velocity and acceleration of knot 0 from the waypoints around it, and tells the knots of
  /// the one before.
  void update(KnotRing& knots) noexcept;

  /// Tells the knots of the interval before knot 0, as `update` has found it.
  void lead_in(KnotRing& knots) const noexcept {
    if (standing_ > 0) knots.lead_in({.h = h_before_, .chord = values(kChord)});
  }

  /// The velocity of knot 0 as the waypoints have it.
  [[nodiscard]] std::span<const double> velocity() const noexcept { return values(kKnotVelocity); }

  /// Takes the acceleration that the knots give at knot 0; while no later knot stands it is the
  /// waypoints' own.
  void take_acceleration(const KnotRing& knots) noexcept;

  /// Takes velocity and acceleration of knot 0 from elsewhere.
  void take(std::span<const double> velocity, std::span<const double> acceleration) noexcept;

  /// Remembers velocity and acceleration of knot 0 as they are.
  void keep() noexcept;

  /// Exchanges the velocity for the one remembered; takes the acceleration remembered.
  void swap_velocities() noexcept;
  void restore_acceleration() noexcept;

  /// The acceleration with which the splice reaches knot 0.
  [[nodiscard]] std::span<const double> acceleration() const noexcept {
    return values(kKnotAcceleration);
  }

  /// The state that the run is entered from.
  [[nodiscard]] Instant state() const noexcept {
    return {.time = time_,
            .position = values(kPosition),
            .velocity = values(kVelocity),
            .acceleration = values(kAcceleration)};
  }

  /// Writes the splice to knot 0.
  void write_splice(const KnotRing& knots, Segment& out) const noexcept;

 private:
  enum Value : std::size_t {
    kPosition,
    kVelocity,
    kAcceleration,
    kKnotVelocity,
    kKnotAcceleration,
    kBefore,   ///< position of the waypoint before knot 0
    kBefore2,  ///< and of the one before that
    kChord,
    kChord2,
    kKeptVelocity,
    kKeptAcceleration,
    kValues
  };
  [[nodiscard]] std::span<double> values(Value which) noexcept {
    return std::span(values_).subspan(which * dimensions_, dimensions_);
  }
  [[nodiscard]] std::span<const double> values(Value which) const noexcept {
    return std::span(values_).subspan(which * dimensions_, dimensions_);
  }

  std::size_t dimensions_;
  Time time_{};
  std::size_t standing_ = 0;  ///< waypoints before, at most two
  Time before_{};
  Time before2_{};
  double h_before_ = 0;  ///< seconds from the waypoint before knot 0 to it, once it has come
  std::vector<double> values_;
};

}  // namespace splinecast::core
