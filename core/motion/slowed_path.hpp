#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/limits/extremes.hpp"
#include "core/limits/position_range.hpp"
#include "core/motion/slowing.hpp"
#include "core/online/sliding_window.hpp"
#include "core/polynomial/segment.hpp"
#include "splinecast/time.hpp"

namespace splinecast::core {

/// Whether a slowed piece stays near `path`, its segment of the path, which begins at `left`:
/// within 0.5 % of `range`, the range of the path from the knot on where the motion begins to slow
/// down, in each dimension. Looks at 7 times. O(D); D is at most kMaxDimensions.
[[nodiscard]] bool stays_near(const Slowing& slowing, const Segment& piece, const SegmentPart& path,
                              Time left, const PositionRange& range) noexcept;

/// The path on which a curve slows down to rest at its last waypoint. First add() its knots in the
/// order of time, then build() its pieces. One thread uses it.
class SlowedPath {
 public:
  explicit SlowedPath(std::size_t dimensions) : before_(dimensions) {}

  /// Number of knots that have been added.
  [[nodiscard]] std::size_t knots() const noexcept { return knots_.size(); }

  /// Sets the acceleration with which the curve reaches the first knot.
  [[nodiscard]] std::span<double> reached() noexcept { return before_; }

  /// Adds a knot and the segment that begins there, both with their final values; after the last
  /// segment, add_last() adds the last knot. Allocates.
  void add(const Knot& knot, const SegmentPart& segment);
  void add_last(const Knot& knot);

  /// The way of the motion along the path. Requires two knots.
  [[nodiscard]] Slowing slowing() const noexcept {
    return {knots_.front().time, knots_.back().time};
  }

  /// Builds the slowed piece after knot i of the path, 0 ≤ i < number of segments added.
  void build(std::size_t i, Segment& out) const;

  /// The waypoint of knot i of the path.
  [[nodiscard]] std::span<const double> waypoint(std::size_t i) const noexcept {
    return knots_[i].waypoint;
  }

 private:
  struct PathKnot {
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

  [[nodiscard]] Slowed slowed(const Slowing& slowing, std::size_t i) const;
  void add_knot(const Knot& knot);

  std::vector<PathKnot> knots_;
  std::vector<double> before_;  ///< acceleration at the end of the last segment that was added
};

}  // namespace splinecast::core
