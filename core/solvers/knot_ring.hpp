#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <vector>

#include "core/forms/chord.hpp"
#include "core/forms/knot_segment.hpp"
#include "core/polynomial/segment.hpp"
#include "core/solvers/smoothing_rows.hpp"
#include "core/solvers/tridiagonal_system.hpp"
#include "splinecast/method.hpp"
#include "splinecast/time.hpp"

namespace splinecast::core {

/// The scalars of a knot's eliminated row: γ, and the smoothing spline's factors.
struct Prefix {
  double gamma = 0;
  SmoothingRow smoothing{};
};

/// The stored data of one knot, sufficient to continue the solve from it. Spans hold one value per
/// dimension.
struct Knot {
  Time time{};
  Prefix prefix{};
  std::uint32_t newer_knots = 0;     ///< number that were known when its velocity was last solved
  std::span<const double> waypoint;  ///< position of its waypoint
  std::span<const double> g;         ///< right side of its eliminated row
  std::span<const double> position;  ///< of the curve: the waypoint, or smoothed
  std::span<const double> velocity;  ///< as solved so far
  std::span<const double> acceleration;  ///< given with the waypoint; empty if not needed
  std::span<const double> residual;      ///< waypoint − position; empty unless the method smooths
};

/// Velocities of consecutive knots: D values each, `stride` values from one knot to the next.
struct KnotVelocities {
  const double* values = nullptr;
  std::size_t stride = 0;
  std::size_t count = 0;
};

/// Allocates arrays that begin on a cache line.
template <typename T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t kCacheLine{64};

  CacheLineAllocator() = default;
  template <typename U>
  CacheLineAllocator(const CacheLineAllocator<U>& /*other*/) noexcept {}  // NOLINT(*-explicit-*)

  [[nodiscard]] T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), kCacheLine));
  }
  void deallocate(T* memory, std::size_t /*count*/) noexcept {
    ::operator delete(memory, kCacheLine);
  }
  friend bool operator==(CacheLineAllocator /*a*/, CacheLineAllocator /*b*/) noexcept {
    return true;
  }
};

/// The last knots of a curve and their elimination prefix, in a ring of fixed capacity that a
/// KnotSolver fills. Knots are numbered from 0 in the order in which they are pushed. Only the
/// constructor allocates. Not thread-safe: one thread uses it.
///
/// Each kind of value has its own array, so that an append, which uses many knots but few kinds of
/// values, touches few cache lines. Values are padded to whole vector registers, with zeros or with
/// the results of the same formulas for zeros.
class KnotRing {
 public:
  /// Values stored for a knot in addition to its row: D of each kind.
  enum Value : std::size_t {
    kWaypoint,
    kChord,  ///< slope from this waypoint to the next
    kG,
    kVelocity,
    kAcceleration,   ///< given, or a of the smoothing spline
    kResidual,       ///< waypoint − smoothed position
    kPosition,       ///< smoothed
    kPositionChord,  ///< slope from this smoothed position to the next
  };
  struct Row {
    Time time{};
    double h = 0;  ///< seconds from this knot to the next, once there is one
  };

  /// Keeps at least the last `capacity` knots (≥ 3) of `dimensions` values each, with the kinds of
  /// values that the method needs. With `halts_at_start` the acceleration at knot 0 is 0.
  KnotRing(std::size_t dimensions, std::size_t capacity, const Method& method, bool halts_at_start);

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

  /// The newest knot; there must be one.
  [[nodiscard]] std::size_t newest() const noexcept { return size_ - 1; }

  /// Appends a knot and measures the interval before it: O(D). It must be later than the newest.
  void push(Time time, std::span<const double> waypoint) noexcept;

  /// Appends a knot and measures the length of the interval before it. The caller writes the
  /// waypoint and the chord slope.
  void push(Time time) noexcept {
    const std::size_t i = size_++;
    place(i, time);
    if (i > 0) row(i - 1).h = to_seconds(time - row(i - 1).time);
  }

  /// Records that knots `first` to the newest have been solved.
  void mark_solved(std::size_t first) noexcept {
    for (; first_solved_ < first; ++first_solved_) {
      newer_knots_[first_solved_ & mask_] = newer_knots(first_solved_);
    }
    first_solved_ = first;
    newest_solved_ = newest();
  }

  /// Number of newer knots that were known when the velocity of knot i was last solved.
  [[nodiscard]] std::uint32_t newer_knots(std::size_t i) const noexcept {
    return i < first_solved_ ? newer_knots_[i & mask_]
                             : static_cast<std::uint32_t>(newest_solved_ - i);
  }

  /// Replaces all knots by those of another ring: `knots` are consecutive, from knot number `first`
  /// to the newest.
  void restore(std::size_t first, std::span<const Knot> knots) noexcept;

  /// Removes all knots, before a new run, which begins with a full stop if `halts_at_start`.
  void clear(bool halts_at_start) noexcept {
    size_ = 0;
    first_solved_ = 0;
    halts_at_start_ = halts_at_start;
    halts_at_end_ = false;
  }

  /// Sets the acceleration at the newest knot to 0, regardless of the knot velocities.
  void halt_at_end() noexcept { halts_at_end_ = true; }

  /// Prefetches the rows and velocities of knots `first` to the one before `end`; does not wait for
  /// them.
  void prefetch(std::size_t first, std::size_t end) const noexcept {
    for (std::size_t i = first; i < end; ++i) {
      __builtin_prefetch(&values_[offset(i, kG)], 1);
      __builtin_prefetch(&values_[offset(i, kVelocity)], 1);
    }
    const std::size_t newest = end - 1;
    for (const std::size_t i : {newest, newest - 1}) {
      __builtin_prefetch(&values_[offset(i, kWaypoint)], 1);
      __builtin_prefetch(&values_[offset(i, kChord)], 1);
      __builtin_prefetch(&rows_[i & mask_], 1);
      __builtin_prefetch(&newer_knots_[i & mask_], 1);
    }
    __builtin_prefetch(&gammas_[first & mask_], 1);
    __builtin_prefetch(&gammas_[newest & mask_], 1);
  }

  [[nodiscard]] Row& row(std::size_t i) noexcept { return rows_[i & mask_]; }
  [[nodiscard]] const Row& row(std::size_t i) const noexcept { return rows_[i & mask_]; }
  [[nodiscard]] double& gamma(std::size_t i) noexcept { return gammas_[i & mask_]; }
  [[nodiscard]] double gamma(std::size_t i) const noexcept { return gammas_[i & mask_]; }
  /// Only for a method that smooths.
  [[nodiscard]] SmoothingRow& smoothing(std::size_t i) noexcept { return smoothing_[i & mask_]; }
  [[nodiscard]] const SmoothingRow& smoothing(std::size_t i) const noexcept {
    return smoothing_[i & mask_];
  }
  [[nodiscard]] std::span<double> values(std::size_t i, Value which) noexcept {
    return {values_.data() + offset(i, which), dimensions_};
  }
  [[nodiscard]] std::span<const double> values(std::size_t i, Value which) const noexcept {
    return {values_.data() + offset(i, which), dimensions_};
  }

  /// The arrays, `slots()` knots long. The values of knot i begin at place_of(i); its γ is at its
  /// slot. A knot has `stride()` values: D, padded to 2 if D ≤ 2, else to a multiple of 4.
  [[nodiscard]] double* array(Value which) noexcept {
    return values_.data() + which * slots() * stride_;
  }
  [[nodiscard]] const double* array_of_gamma() const noexcept { return gammas_.data(); }
  [[nodiscard]] std::size_t slots() const noexcept { return mask_ + 1; }
  [[nodiscard]] std::size_t stride() const noexcept { return stride_; }
  [[nodiscard]] std::size_t place_of(std::size_t i) const noexcept { return (i & mask_) * stride_; }
  /// Number of knots up to i, including i, that are contiguous in the arrays.
  [[nodiscard]] std::size_t contiguous(std::size_t i) const noexcept { return (i & mask_) + 1; }

  /// The velocities of up to `count` knots from i on, as many as are contiguous.
  [[nodiscard]] KnotVelocities velocities(std::size_t i, std::size_t count) const noexcept {
    return {.values = values_.data() + offset(i, kVelocity),
            .stride = stride_,
            .count = std::min(count, slots() - (i & mask_))};
  }

  /// The position of the curve at knot i, and its chord slope from there to knot i+1.
  [[nodiscard]] std::span<const double> position(std::size_t i) const noexcept {
    return values(i, smooths_ ? kPosition : kWaypoint);
  }
  [[nodiscard]] std::span<const double> chord(std::size_t i) const noexcept {
    return values(i, smooths_ ? kPositionChord : kChord);
  }

  /// The intervals around knot i, and those at the ends, with the chords of the curve. The ends
  /// need two knots.
  [[nodiscard]] Neighbours neighbours(std::size_t i) const noexcept;
  [[nodiscard]] EndIntervals start_intervals() const noexcept;
  [[nodiscard]] EndIntervals end_intervals() const noexcept;

  [[nodiscard]] Knot knot(std::size_t i) const noexcept {
    return {.time = row(i).time,
            .prefix = {.gamma = gamma(i), .smoothing = smooths_ ? smoothing(i) : SmoothingRow{}},
            .newer_knots = newer_knots(i),
            .waypoint = values(i, kWaypoint),
            .g = values(i, kG),
            .position = position(i),
            .velocity = values(i, kVelocity),
            .acceleration = has_accelerations_ ? values(i, kAcceleration) : kNone,
            .residual = smooths_ ? values(i, kResidual) : kNone};
  }

  /// The interval between knots i and i+1, both of which must still be kept.
  [[nodiscard]] Interval interval(std::size_t i) const noexcept {
    Interval interval{.left = row(i).time,
                      .right = row(i + 1).time,
                      .h = row(i).h,
                      .x0 = position(i),
                      .chord = chord(i),
                      .v0 = values(i, kVelocity),
                      .v1 = values(i + 1, kVelocity),
                      .a0 = has_accelerations_ ? values(i, kAcceleration) : kNone,
                      .a1 = has_accelerations_ ? values(i + 1, kAcceleration) : kNone};
    if (halts_at_start_ || halts_at_end_) halt(i, interval);
    return interval;
  }

  /// The form of the segment of that interval.
  [[nodiscard]] SegmentForm form(std::size_t i) const noexcept {
    if (has_accelerations_) return SegmentForm::quintic;
    const bool halts_left = halts_at_start_ && i == 0;
    const bool halts_right = halts_at_end_ && i + 1 == newest();
    if (halts_left) return halts_right ? SegmentForm::halt_both : SegmentForm::halt_left;
    return halts_right ? SegmentForm::halt_right : SegmentForm::cubic;
  }

  /// Writes the smoothed chord slope of interval i from the residuals at both its ends.
  void measure_smoothed(std::size_t i) noexcept;

  /// Writes the acceleration with which the curve reaches the newest knot.
  void write_final_acceleration(std::span<double> acceleration) const noexcept;

 private:
  static constexpr std::span<const double> kNone{};
  template <typename T>
  using LineVector = std::vector<T, CacheLineAllocator<T>>;

  void halt(std::size_t i, Interval& interval) const noexcept;
  [[nodiscard]] std::size_t offset(std::size_t i, Value which) const noexcept {
    return which * slots() * stride_ + place_of(i);
  }
  void place(std::size_t i, Time time) noexcept {
    row(i) = {.time = time, .h = 0};
    gamma(i) = 0;
    if (smooths_) smoothing(i) = {};
  }
  void measure_chord(std::size_t i) noexcept;

  std::size_t dimensions_;
  bool smooths_;
  bool has_accelerations_;  ///< given with the waypoints
  bool halts_at_start_;
  bool halts_at_end_ = false;
  std::size_t mask_;
  std::size_t stride_;
  std::size_t kinds_;  ///< number of kinds of values stored
  std::size_t size_ = 0;
  std::size_t first_solved_ = 0;   ///< the knots from here on were last solved together
  std::size_t newest_solved_ = 0;  ///< the newest knot of that solve
  LineVector<Row> rows_;           ///< [knot & mask], as all arrays
  LineVector<double> gammas_;
  LineVector<double> values_;              ///< [which][knot & mask][dimension, then padding]
  LineVector<std::uint32_t> newer_knots_;  ///< of knots before first_solved_
  LineVector<SmoothingRow> smoothing_;     ///< empty unless the method smooths
};

/// Writes the acceleration step a⁺ − a⁻ at the left knot of interval i, which is `interval`. At
/// knot 0 the step is a⁺ if a hold precedes the knot (`held_before`), else 0.
void write_acceleration_step(const KnotRing& knots, std::size_t i, const Interval& interval,
                             bool held_before, std::span<double> step) noexcept;

}  // namespace splinecast::core
