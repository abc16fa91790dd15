#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/forms/slowing.hpp"
#include "core/online/sliding_window.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The path on which a curve slows down to rest at its last waypoint, as it is solved again. First
/// add() its knots in the order of time, then build() its pieces. One thread uses it.
class SlowedPath {
 public:
  explicit SlowedPath(std::size_t dimensions) : piece_(dimensions), before_(dimensions) {}

  /// Number of knots that have been added.
  [[nodiscard]] std::size_t knots() const noexcept { return knots_.size(); }

  /// Sets the acceleration with which the curve reaches the first knot.
  [[nodiscard]] std::span<double> reached() noexcept { return before_; }

  /// Adds knot i of the target and the segment that begins there, both with their final values;
  /// after the last segment, add_last() adds the last knot. Allocates.
  void add(const core::SlidingWindow& target, std::size_t i);
  void add_last(const core::SlidingWindow& target);

  /// Builds the slowed piece after knot i of the path, 0 ≤ i < number of segments added.
  void build(std::size_t i, core::Segment& out) const;

  /// The waypoint of knot i of the path.
  [[nodiscard]] std::span<const double> waypoint(std::size_t i) const noexcept {
    return knots_[i].waypoint;
  }

 private:
  struct Knot {
    Time time{};
    std::vector<double> waypoint;
    std::vector<double> residual;
    std::vector<double> velocity;
    std::vector<double> given;  ///< acceleration; empty unless the method needs it
    std::vector<double> before;
    std::vector<double> after;
  };
  /// Values of a knot that is slowed down.
  struct Slowed {
    Time time{};
    std::vector<double> velocity;
    std::vector<double> acceleration;
  };

  [[nodiscard]] Slowed slowed(const core::Slowing& slowing, std::size_t i) const;
  void add_knot(const core::Knot& knot);

  std::vector<Knot> knots_;
  core::Segment piece_;         ///< scratch
  std::vector<double> before_;  ///< acceleration at the end of the last segment that was added
};

}  // namespace splinecast::ipc
