#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/forms/knot_segment.hpp"
#include "core/polynomial/segment.hpp"
#include "core/slopes/rule.hpp"
#include "core/solvers/knot_ring.hpp"
#include "core/solvers/knot_solver.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/method.hpp"

namespace splinecast::core {

/// Largest settle lag. The effect of a new waypoint has faded below 2⁻⁵² after 52 knots on the
/// worst mesh, so that a longer lag would change no bit.
inline constexpr std::size_t kMaxSettle = 64;

/// The settle lag that a method has when none is asked for: 8 for `c2`, the look-ahead of a local
/// method, which is then exact, and kMaxSettle for `smoothing`.
[[nodiscard]] std::size_t default_settle(const Method& method) noexcept;

/// What shapes a curve that is solved online.
struct WindowOptions {
  Interpolant interpolant{};
  std::size_t settle = 8;    ///< settle lag K: the method's look-ahead … kMaxSettle newer knots
  Tail tail = Tail::bessel;  ///< condition at the newest knot while the stream goes on; `hermite`,
                             ///< `quintic` and `smoothing` have one of their own
  Condition start{.kind = ConditionKind::own, .value = {}};  ///< condition at knot 0
  Time stop_time{250'000'000};     ///< length of the stop, > 0; with limits the least length
  MotionLimits limits{};           ///< that stops and entries keep to
  bool held_before_start = false;  ///< a hold stands before knot 0, as on a live stream
  bool force_lag = false;          ///< take a lag that is too short for λ
};

/// The online spline: the knots that an append still changes, and the segments at them.
///
/// Invariants, for newest knot n and settle lag K:
/// - knot i is *converged* once i + K ≤ n; no append touches it again. Its velocity (and its
///   position, if the method smooths) is that of a full solve over waypoints 0 … i+K with the
///   tail at the last; of a local method it is exact;
/// - a converged velocity is no boundary condition: the elimination prefix goes on unchanged, so
///   that truncations never accumulate;
/// - segment i lies between knots i and i+1; segment n is the stop tail, until `finish`.
///
/// A *run* is a sequence of knots that one elimination goes through. The first run begins with the
/// start condition; `begin_run` begins another one, whose first velocity comes from its waypoints,
/// and knots are counted from there. A live stream also *freezes*: what readers may have
/// executed stays, converged or not.
///
/// Allocates when made only. Not thread-safe: one thread uses it.
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

  /// Number of segments of this run so far, the stop included; segment i begins at knot i.
  [[nodiscard]] std::size_t segments() const noexcept;

  /// Number of leading segments that nothing changes any more.
  [[nodiscard]] std::size_t settled_segments() const noexcept;

  /// Number of leading knots of this run at which nothing changes any more.
  [[nodiscard]] std::size_t settled_knots() const noexcept;

  /// The form of the segment that begins at knot i, which must still be in the window.
  [[nodiscard]] SegmentForm form(std::size_t i) const noexcept;

  /// Writes the acceleration that the curve reaches the newest knot with, D values, and returns how
  /// long the stop behind it takes. There must be a knot, and the stream must not be finished.
  /// O(D).
  [[nodiscard]] Time write_stop(std::span<double> acceleration) const noexcept;

  /// Writes the acceleration at knot i, which must still be in the window: with which the segment
  /// that begins there starts, or, at the newest knot, with which the one before it arrives. O(D).
  void write_acceleration(std::size_t i, std::span<double> acceleration) const noexcept;

  /// The oldest segment that can still be asked for.
  [[nodiscard]] std::size_t oldest_segment() const noexcept;

  [[nodiscard]] bool finished() const noexcept { return finished_; }

  /// Whether a waypoint carries the velocity and acceleration that the method needs.
  [[nodiscard]] bool takes(const Waypoint& waypoint) const noexcept;

  /// Whether the knots that a waypoint at `time` would settle have had enough of the curve ahead of
  /// them for λ: see smoothing_lag, with the mean of those intervals. Always so but for
  /// `smoothing`, and with `force_lag`. O(1).
  [[nodiscard]] bool lag_suffices(Time time) const noexcept;

  /// Appends a waypoint: its forward rows and K backward rows for all dimensions at once,
  /// O(K·D) whatever the length of the stream. It must be later than the newest knot, finite, and
  /// one that the method takes: the caller has checked. Changes the segments from
  /// `settled_segments()` as it was before the call (with K = 0: from the one it adds).
  void append(const Waypoint& waypoint) noexcept;

  /// Begins a run. O(1). The velocity of its first knot follows its first three waypoints.
  void begin_run() noexcept;

  /// Keeps every knot of this run up to the right end of the segment that contains t as it is: no
  /// append changes the segments between them. O(1) amortised.
  void freeze(Time t) noexcept;

  /// Keeps so many leading knots of this run as they are, or all if there are fewer; what is frozen
  /// stays so until `thaw_knots`.
  void freeze_knots(std::size_t count) noexcept;

  /// Lets appends change all knots behind the leading `count` again that have not converged.
  void thaw_knots(std::size_t count) noexcept { frozen_ = std::min(frozen_, count); }

  /// Number of leading knots that are frozen.
  [[nodiscard]] std::size_t frozen_knots() const noexcept { return frozen_; }

  /// Ends the stream at its newest knot, with a condition there that may change what has not
  /// converged; `own` is a halt for `c2`. No append may follow. The condition must be one for
  /// streams and its values must have been checked.
  void finish(const Condition& end) noexcept;

  /// Writes segment i, oldest_segment() ≤ i < segments(), with its acceleration step: O(D).
  /// `out` must have this window's dimensions.
  void segment(std::size_t i, Segment& out) const noexcept;

  /// Asks for the memory that an append goes through. Loads nothing.
  void prefetch() const noexcept {
    __builtin_prefetch(solver_.get());
    knots_.prefetch(knots() - std::min(knots(), options_.settle), knots() + 1);
  }

  /// What is kept of knot i, which must still be in the window: what `restore` needs.
  [[nodiscard]] Knot knot(std::size_t i) const noexcept { return knots_.knot(i); }

  /// Time of knot i, as above.
  [[nodiscard]] Time time(std::size_t i) const noexcept { return knots_.row(i).time; }

  /// Velocities of up to `count` knots from i on, as above: at least that of the first.
  [[nodiscard]] KnotVelocities velocities(std::size_t i, std::size_t count) const noexcept {
    return knots_.velocities(i, count);
  }

  /// How many newer knots knot i had seen when its velocity was last solved.
  [[nodiscard]] std::uint32_t newer_knots_seen(std::size_t i) const noexcept {
    return knots_.newer_knots(i);
  }

  /// How many of its newest knots a window needs in order to go on where another one stood.
  [[nodiscard]] std::size_t knots_to_restore() const noexcept { return reach() + kMaxReach + 3; }

  /// Goes on where the first run of a window with the same options stood: `first` is the number of
  /// the oldest knot given; `knots` are its consecutive knots up to the newest, at least
  /// min(first + knots.size(), knots_to_restore()) of them. The stream must not be finished.
  void restore(std::size_t first, std::span<const Knot> knots) noexcept;

  /// The same for a later run.
  void restore_run(std::size_t first, std::span<const Knot> knots) noexcept;

 private:
  static constexpr std::size_t kKnotsThatShapeTheStart = 3;

  /// How many knots before the newest one an append or the finish may change. With K = 0 an append
  /// leaves the newest knot's velocity alone, but `finish` may change it.
  [[nodiscard]] std::size_t reach() const noexcept {
    return options_.settle > 0 ? options_.settle : 1;
  }
  /// An exact method's slope at the start may look one knot further than the slopes within: knot 0
  /// stays open as long as its segment does.
  [[nodiscard]] bool is_start_open(std::size_t newest) const noexcept {
    return newest <= reach() + 1 && !options_.interpolant.method->converges();
  }
  /// The first knot that an append solves whose own knot is `newest`.
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
  KnotRing knots_;
  std::unique_ptr<KnotSolver> solver_;
  std::vector<double> run_start_;  ///< velocity at knot 0 of a later run
  bool is_later_run_ = false;
  std::size_t first_ = 0;  ///< oldest knot that was restored
  std::size_t frozen_ = 0;
  bool finished_ = false;
};

}  // namespace splinecast::core
