#include <algorithm>
#include <array>

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

bool SlidingWindow::can_append(std::span<const Waypoint> waypoints) noexcept {
  const auto& limits = options_.max_acceleration;
  const std::size_t before = knots();
  if (limits.empty()) return true;
  if (is_entry_open() && before < kKnotsThatShapeTheEntry) return can_shape_entry(waypoints);
  const bool starts = !is_entered_ && before == 1;
  const bool goes_on = before > 0 && frozen_ == before;
  if (starts) return can_follow_first(waypoints);
  return !goes_on || keeps_behind_newest(waypoints);
}

/// Whether the interval to the first of these waypoints keeps within the limits: tried, and taken
/// back.
bool SlidingWindow::keeps_behind_newest(std::span<const Waypoint> waypoints) noexcept {
  const std::size_t before = knots();
  for (const Waypoint& waypoint : waypoints) (void)push_into_entry(waypoint);
  build_segment(knots_.interval(before - 1), splice_);
  while (knots() > before) knots_.pop();
  return acceleration_excess(options_.max_acceleration, splice_) <= kShareOfLimit;
}

/// The same behind the only knot of a curve, which what follows it also shapes.
bool SlidingWindow::can_follow_first(std::span<const Waypoint> waypoints) noexcept {
  const Knot knot = knots_.knot(0);
  std::array<double, 3 * kMaxDimensions> values{};
  const auto copy = [&](std::size_t part, std::span<const double> from) {
    const auto to = std::span(values).subspan(part * kMaxDimensions, from.size());
    std::ranges::copy(from, to.begin());
    return to;
  };
  const Waypoint first{.time = knot.time,
                       .position = copy(0, knot.waypoint),
                       .velocity = copy(1, knot.velocity),
                       .acceleration = copy(2, knot.acceleration)};
  const bool keeps = keeps_behind_newest(waypoints);
  knots_.pop();
  solver_->push(knots_, first);
  solve(options_.tail, 0);
  return keeps;
}

/// Whether waypoints leave an open entry within the limits: tried, and taken back.
bool SlidingWindow::can_shape_entry(std::span<const Waypoint> waypoints) noexcept {
  std::array<double, kMaxDimensions> v{};
  std::array<double, kMaxDimensions> a{};
  std::ranges::copy(entry_.velocity(), v.begin());
  std::ranges::copy(entry_.acceleration(), a.begin());
  const std::uint32_t entry_newer_knots = entry_newer_knots_;
  const std::size_t before = knots();
  keep_first_knots();
  bool keeps = true;
  for (const Waypoint& waypoint : waypoints) {
    if (knots() == kKnotsThatShapeTheEntry) break;
    append(waypoint);
    // Also alone: those that follow the first one may be refused.
    entry_.write_splice(knots_, splice_);
    if (before == 0) keeps = keeps && keeps_within(options_.max_acceleration, splice_);
  }
  if (before > 0) keeps = entry_excess() <= kShareOfLimit;
  while (knots() > before) knots_.pop();
  if (before == 0) return keeps;
  entry_.take(std::span(v).first(dimensions()), std::span(a).first(dimensions()));
  start_with_entry();
  solve(options_.tail, 0);
  entry_.take(std::span(v).first(dimensions()), std::span(a).first(dimensions()));
  restore_first_knots();
  entry_newer_knots_ = entry_newer_knots;
  return keeps;
}

/// Keeps what a second solve would not restore of the knots that a trial solves again: with a short
/// lag their velocities are those of an earlier solve.
void SlidingWindow::keep_first_knots() noexcept {
  for (std::size_t i = 0; i < knots(); ++i) {
    std::ranges::copy(knots_.values(i, KnotRing::kVelocity), kept_velocities_[i].begin());
    kept_newer_knots_[i] = knots_.row(i).newer_knots;
  }
}

void SlidingWindow::restore_first_knots() noexcept {
  for (std::size_t i = 0; i < knots(); ++i) {
    std::ranges::copy(std::span(kept_velocities_[i]).first(dimensions()),
                      knots_.values(i, KnotRing::kVelocity).begin());
    knots_.row(i).newer_knots = kept_newer_knots_[i];
  }
}

/// The largest ratio of acceleration to limit in the splice and in the first interval behind it.
double SlidingWindow::entry_excess() noexcept {
  build_segment(knots_.interval(0), splice_);
  const double behind = acceleration_excess(options_.max_acceleration, splice_);
  entry_.write_splice(knots_, splice_);
  return std::max(behind, acceleration_excess(options_.max_acceleration, splice_));
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
