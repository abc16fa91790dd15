#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/forms/knot_segment.hpp"
#include "core/forms/stop.hpp"
#include "core/polynomial/segment.hpp"
#include "core/slopes/rule.hpp"
#include "core/solvers/knot_ring.hpp"
#include "core/solvers/knot_solver.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/method.hpp"

namespace splinecast::core {

/// Largest settle lag. After 52 knots the effect of a new waypoint is below 2⁻⁵² on the worst mesh,
/// so that a longer lag would change no bit.
inline constexpr std::size_t kMaxSettle = 64;

/// The default settle lag of a method: 8 for `c2`; the look-ahead for a local method, which is then
/// exact; kMaxSettle for `smoothing`.
[[nodiscard]] std::size_t default_settle(const Method& method) noexcept;

/// Options of a curve that is solved online.
struct WindowOptions {
  Interpolant interpolant{};
  std::size_t settle = 8;    ///< settle lag K: the method's look-ahead … kMaxSettle newer knots
  Tail tail = Tail::bessel;  ///< condition at the newest knot while the stream continues; fixed for
                             ///< `hermite`, `quintic` and `smoothing`
  Condition start{.kind = ConditionKind::own, .value = {}};  ///< condition at knot 0
  Time stop_length{250'000'000};   ///< length of the stop segment, > 0: see StopRules
  MotionLimits limits{};           ///< given limits, for the rate 1
  DimensionKinds kinds{};          ///< of the dimensions, for the limits of rotations
  double max_rate = 1;             ///< of the time law that the stream follows: above 0
  bool held_before_start = false;  ///< a hold precedes knot 0, as on a live stream
  bool accepts_short_lag = false;  ///< accept a lag that is too short for λ
};

/// These options for dimensions of these kinds. May allocate.
[[nodiscard]] WindowOptions with_kinds(WindowOptions options, const DimensionKinds& kinds);

/// The online spline: the knots that an append still changes, and their segments.
///
/// Invariants, for newest knot n and settle lag K:
/// - knot i is *converged* once i + K ≤ n; no append changes it again. Its velocity (and its
///   position, if the method smooths) is that of a full solve over waypoints 0 … i+K with the tail
///   condition at the last; for a local method it is exact;
/// - a converged velocity is not a boundary condition: the elimination prefix continues unchanged,
///   so that truncation errors never accumulate;
/// - segment i is between knots i and i+1; segment n is the stop segment, until `finish`.
///
/// A *run* is a sequence of knots with one elimination. The first run begins with the start
/// condition. `begin_run` begins another one: its first velocity follows from its waypoints, and
/// its knots are numbered from 0. A live stream also *freezes* knots: segments that readers may
/// have executed do not change, whether or not they have converged.
///
/// Only the constructor allocates. Not thread-safe: one thread uses it.
class SlidingWindow {
 public:
  /// Throws std::invalid_argument for dimensions, a method, a parameter, a lag, a stop time or
  /// start values out of range, and for conditions or methods that cannot be met online.
  SlidingWindow(std::size_t dimensions, WindowOptions options);

  [[nodiscard]] std::size_t dimensions() const noexcept { return knots_.dimensions(); }
  [[nodiscard]] const WindowOptions& options() const noexcept { return options_; }

  /// Number of knots of this run so far.
  [[nodiscard]] std::size_t knots() const noexcept { return knots_.size(); }

  /// Whether this is a run that `begin_run` has begun.
  [[nodiscard]] bool is_later_run() const noexcept { return is_later_run_; }

  /// Number of segments of this run so far, including the stop segment; segment i begins at knot i.
  [[nodiscard]] std::size_t segments() const noexcept;

  /// Number of leading segments that no longer change.
  [[nodiscard]] std::size_t settled_segments() const noexcept;

  /// Number of leading knots of this run that no longer change.
  [[nodiscard]] std::size_t settled_knots() const noexcept;

  /// The form of the segment that begins at knot i, which must still be in the window.
  [[nodiscard]] SegmentForm form(std::size_t i) const noexcept;

  /// Writes the acceleration with which the stop segment after the newest knot begins, D values,
  /// before it is clamped, and returns the length of the stop. There must be a knot, and the stream
  /// must not be finished. Cost: see stop_time_within.
  [[nodiscard]] Time write_stop(std::span<double> acceleration) const noexcept;

  /// The length of the stop segment if it begins with this acceleration.
  [[nodiscard]] Time stop_length(std::span<const double> acceleration) const noexcept;

  /// The limits of stops and entries: the given ones, divided so that the motion keeps them also at
  /// the largest rate of the time law.
  [[nodiscard]] const MotionLimits& limits_at_largest_rate() const noexcept {
    return limits_at_largest_rate_;
  }
  [[nodiscard]] const DimensionKinds& kinds() const noexcept { return options_.kinds; }

  /// What decides the length of a stop.
  [[nodiscard]] StopRules stop_rules() const noexcept {
    return {limits_at_largest_rate_, kinds(), options_.stop_length};
  }

  /// Writes the acceleration at knot i, which must still be in the window: that at the start of the
  /// segment after it or, for the newest knot, that at the end of the segment before it. O(D).
  void write_acceleration(std::size_t i, std::span<double> acceleration) const noexcept;

  /// The oldest segment that is still available.
  [[nodiscard]] std::size_t oldest_segment() const noexcept;

  [[nodiscard]] bool finished() const noexcept { return finished_; }

  /// Whether a waypoint carries the velocity and acceleration that the method needs.
  [[nodiscard]] bool takes(const Waypoint& waypoint) const noexcept;

  /// Whether the settle lag is long enough for λ (see smoothing_lag) at the knots that a waypoint
  /// at `time` would settle. Uses the mean interval over the lag. Always true for methods other
  /// than `smoothing`, and with `accepts_short_lag`. O(1).
  [[nodiscard]] bool lag_suffices(Time time) const noexcept;

  /// Appends a waypoint: its forward rows and K backward rows for all dimensions at once, O(K·D)
  /// for any length of the stream. The waypoint must be later than the newest knot, finite and
  /// accepted by `takes`; the caller checks this. Changes the segments from the previous value of
  /// `settled_segments()` on (with K = 0: only from the new segment on).
  void append(const Waypoint& waypoint) noexcept;

  /// Begins a run. O(1). The velocity of its first knot follows from its first three waypoints.
  void begin_run() noexcept;

  /// Freezes every knot of this run up to the right end of the segment that contains t: no append
  /// changes the segments between these knots. O(1) amortised.
  void freeze(Time t) noexcept;

  /// Freezes the leading `count` knots of this run, or all if there are fewer, until `thaw_knots`.
  void freeze_knots(std::size_t count) noexcept;

  /// Unfreezes the knots after the leading `count`: appends may change those that have not
  /// converged.
  void thaw_knots(std::size_t count) noexcept { frozen_ = std::min(frozen_, count); }

  /// Number of leading knots that are frozen.
  [[nodiscard]] std::size_t frozen_knots() const noexcept { return frozen_; }

  /// Ends the stream at its newest knot, with a boundary condition there, which may change knots
  /// that have not converged; `own` is a full stop for `c2`. No append may follow. The condition
  /// must be one that is_online() accepts, with values that have been checked.
  void finish(const Condition& end) noexcept;

  /// Writes segment i, oldest_segment() ≤ i < segments(), with its acceleration step: O(D).
  /// `out` must have this window's dimensions.
  void segment(std::size_t i, Segment& out) const noexcept;

  /// Prefetches the memory that `append` will touch; does not wait for it.
  void prefetch() const noexcept {
    __builtin_prefetch(solver_.get());
    knots_.prefetch(knots() - std::min(knots(), options_.settle), knots() + 1);
  }

  /// The stored data of knot i, which must still be in the window, as `restore` needs it.
  [[nodiscard]] Knot knot(std::size_t i) const noexcept { return knots_.knot(i); }

  /// Time of knot i, as above.
  [[nodiscard]] Time time(std::size_t i) const noexcept { return knots_.row(i).time; }

  /// Velocities of up to `count` knots from i on, at least that of knot i, which must still be in
  /// the window.
  [[nodiscard]] KnotVelocities velocities(std::size_t i, std::size_t count) const noexcept {
    return knots_.velocities(i, count);
  }

  /// Number of newer knots that were known when the velocity of knot i was last solved.
  [[nodiscard]] std::uint32_t newer_knots_seen(std::size_t i) const noexcept {
    return knots_.newer_knots(i);
  }

  /// Number of the newest knots that another window needs to continue from this one.
  [[nodiscard]] std::size_t knots_to_restore() const noexcept { return reach() + kMaxReach + 3; }

  /// The first of them, or knot 0 if there are fewer.
  [[nodiscard]] std::size_t first_to_restore() const noexcept {
    return knots() - std::min(knots(), knots_to_restore());
  }

  /// Continues the first run of a window with the same options. `knots` are consecutive, from knot
  /// number `first` to the newest: at least knots_to_restore() of them, or all knots of the run if
  /// it has fewer. The stream must not be finished.
  void restore(std::size_t first, std::span<const Knot> knots) noexcept;

  /// The same for a later run.
  void restore_run(std::size_t first, std::span<const Knot> knots) noexcept;

  /// Continues from another window with the same options, whose stream is not finished. `scratch`:
  /// knots_to_restore() knots. O(K·D).
  void copy_from(const SlidingWindow& other, std::span<Knot> scratch) noexcept;

 private:
  static constexpr std::size_t kKnotsThatShapeTheStart = 3;

  /// Number of knots before the newest one that `append` or `finish` may change. With K = 0,
  /// `append` does not change the velocity of an existing knot, but `finish` changes that of the
  /// newest.
  [[nodiscard]] std::size_t reach() const noexcept {
    return options_.settle > 0 ? options_.settle : 1;
  }
  /// Whether the append of knot `newest` may change knot 0. For a local method, the slope at the
  /// start may depend on one knot more than the slopes after it.
  [[nodiscard]] bool is_start_open(std::size_t newest) const noexcept {
    return newest <= reach() + 1 && !options_.interpolant.method->converges();
  }
  /// The first knot that the append of knot `newest` solves.
  [[nodiscard]] std::size_t first_to_solve(std::size_t newest) const noexcept {
    const std::size_t last = is_start_open(newest) ? 0 : newest - std::min(newest, options_.settle);
    return std::min(std::max(last, frozen_), newest);
  }
  void solve(const auto& closing, std::size_t last) noexcept;
  void append_to_start(const Waypoint& waypoint) noexcept;
  void start_with_waypoints() noexcept;
  void rest_at_only_knot() noexcept;
  [[nodiscard]] std::size_t oldest_knot() const noexcept;
  WindowOptions options_;
  MotionLimits limits_at_largest_rate_;
  KnotRing knots_;
  std::unique_ptr<KnotSolver> solver_;
  std::vector<double> run_start_;  ///< velocity at knot 0 of a later run
  bool is_later_run_ = false;
  std::size_t first_ = 0;  ///< oldest knot that was restored
  std::size_t frozen_ = 0;
  bool finished_ = false;
};

}  // namespace splinecast::core
