#include <algorithm>

#include "splinecast/core/limits.hpp"
#include "splinecast/core/sliding_window.hpp"

/// What acceleration limits ask of a window: which waypoints it can append, and how a splice keeps
/// within them.
namespace splinecast::core {
namespace {

/// The share of an acceleration limit that a new waypoint may use: later ones still change the
/// curve.
constexpr double kShareOfLimit = 0.9;

}  // namespace

bool SlidingWindow::can_append(std::span<const Waypoint> waypoints,
                               SlidingWindow& trial) const noexcept {
  if (options_.limits.acceleration.empty()) return true;
  const bool shapes = is_entry_open() && knots() < kKnotsThatShapeTheEntry;
  const bool starts = !is_entered_ && knots() == 1;
  const bool goes_on = knots() > 0 && frozen_ == knots();
  if (!shapes && !starts && !goes_on) return true;
  trial.assign(*this);
  return shapes ? trial.keeps_in_entry(waypoints) : trial.keeps_behind_newest(waypoints);
}

/// Appends waypoints. Whether the interval to the first of them keeps within the limits.
bool SlidingWindow::keeps_behind_newest(std::span<const Waypoint> waypoints) noexcept {
  const std::size_t before = knots();
  for (const Waypoint& waypoint : waypoints) (void)push_into_entry(waypoint);
  build_segment(knots_.interval(before - 1), splice_);
  return acceleration_excess(options_.limits.acceleration, splice_) <= kShareOfLimit;
}

bool SlidingWindow::keeps_in_entry(std::span<const Waypoint> waypoints) noexcept {
  const bool is_first = knots() == 0;
  bool keeps = true;
  for (const Waypoint& waypoint : waypoints) {
    if (knots() == kKnotsThatShapeTheEntry) break;
    append(waypoint);
    if (!is_first) continue;
    // Also alone: those that follow the first one may be refused.
    entry_.write_splice(knots_, splice_);
    keeps = keeps && keeps_within(options_.limits.acceleration, splice_);
  }
  return is_first ? keeps : entry_excess() <= kShareOfLimit;
}

/// The largest ratio of acceleration to limit in the splice and in the first interval behind it.
double SlidingWindow::entry_excess() noexcept {
  build_segment(knots_.interval(0), splice_);
  const double behind = acceleration_excess(options_.limits.acceleration, splice_);
  entry_.write_splice(knots_, splice_);
  return std::max(behind, acceleration_excess(options_.limits.acceleration, splice_));
}

/// Compares the entry's present velocity with its earlier one, and takes the one with the smaller
/// accelerations around the first knot.
void SlidingWindow::take_better_entry() noexcept {
  const double excess = entry_excess();
  const auto exchange = [this] {
    entry_.swap_velocities();
    start_with_entry();
    solve(options_.tail, 0);
  };
  exchange();
  if (entry_excess() > excess) exchange();
}

}  // namespace splinecast::core
