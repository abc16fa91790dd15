#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "splinecast/clock.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/options.hpp"
#include "splinecast/snapshot.hpp"
#include "splinecast/state.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {
class Sampler;
struct Internals;
struct LawPoint;
}  // namespace splinecast::ipc

namespace [[gnu::visibility("default")]] splinecast {

/// Why `Reader::wait` returned.
enum class WaitStatus : std::uint8_t {
  advanced,  ///< there is a revision that this reader has not seen
  timed_out,
  retired,  ///< make a new Reader
};

/// Which writers of a stream live.
struct Alive {
  bool producer = false;
  bool solver = false;
};

/// The time law of a stream at one instant of host time.
struct LawRate {
  Time stream_time{};  ///< rounded down to nanoseconds
  double rate = 1;     ///< stream time per host time
  double slope = 0;    ///< change of the rate [1/s]
};

/// The progress of a stream's curve, under one revision.
struct CurveProgress {
  std::uint64_t revision = 0;
  Time newest{};                ///< time of the newest waypoint; of the start state or replacement
                                ///< if no waypoint has followed it
  Time settled_until{};         ///< no later revision changes the curve before this time
  bool is_finished = false;     ///< the stream has been finished: no waypoint follows
  std::uint64_t waypoints = 0;  ///< accepted by the solver, over the stream's life
  std::uint64_t refused = 0;    ///< items that the solver refused
};

/// The role that reads the curve, for controllers. Any number of processes may read one stream. One
/// thread uses a reader; each thread may have its own.
class Reader {
 public:
  /// Maps the stream's knot board; waits for it up to `wait`, polling every 2 ms. Throws BadRequest
  /// for an invalid stream name (1 to 128 of A-Z a-z 0-9 . _ -, no leading dot), NoSuchStream if no
  /// board has appeared by then, BadRegion if the board cannot be used. If a stream was created
  /// again, its board appears when the earlier motion has ended; until then a reader attaches to
  /// the earlier one, whose samples are `retired` afterwards.
  explicit Reader(const std::string& stream, Time wait = Time::zero(), const Trust& trust = {});
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }

  /// Evaluates position, velocity, acceleration and jerk at time `t` into `out`, one value per
  /// dimension in each span. Periodic dimensions are within half a period of 0; quaternions have
  /// unit length (angular_motion gives their ω and α). Wait-free: no system call, no allocation, no
  /// store to shared memory, regardless of what the writers do. O(D) when time advances,
  /// O(log n + D) after a jump. A status without values leaves `out` unchanged. A span of another
  /// size gives `wrong_dimension`, for example after attaching to a stream of other dimensions.
  ///
  /// `t` is a time of clock(): CLOCK_MONOTONIC for a live stream. On a live stream a sample counts
  /// as executed: if a later revision changes the curve at or before the latest time sampled, the
  /// next sample is `revised`, once. To look ahead of settled_until(), use `preview` or
  /// `sample_many`.
  [[nodiscard]] SampleStatus sample(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus sample(Time t, State& out) noexcept { return sample(t, out.ref()); }

  /// Like sample, for a time ahead of settled_until(), but does not count as executed.
  [[nodiscard]] SampleStatus preview(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus preview(Time t, State& out) noexcept { return preview(t, out.ref()); }

  /// Evaluates the curve at any number of times, in any order, all under *one* revision: for
  /// controllers whose horizon must not mix two revisions. Returns that revision, or 0 if none
  /// could be read: then every status says why, and none has values. Does not count as executed.
  /// Wait-free, like `sample`: a bounded number of tries, each O(N·D) if the times advance
  /// steadily, at most O(N·(log n + D)). `busy` if the writer publishes faster than a try takes.
  /// `wrong_dimension` if the sizes of the block do not match the times and the curve.
  std::uint64_t sample_many(std::span<const Time> times, const SampleBlock& out) noexcept;

  /// The rate of the law that the stream follows, as the last sample or preview saw it, and its
  /// stream time. Of a stream without a law: rate 1 and stream time 0.
  [[nodiscard]] LawRate rate() const noexcept { return rate_; }

  /// The settled time of the curve that the last sample or look-ahead used: that curve never
  /// changes before this time. Before the first sample, the earliest time that a curve can have. On
  /// a stream that follows a law, of the newest curve, in stream time.
  [[nodiscard]] Time settled_until() const noexcept;

  /// Copies every segment that overlaps the closed interval from `from` to `to`, all under one
  /// revision. Returns `settled` or `provisional` for the whole. With `before_history`, `no_data`,
  /// `busy`, `retired` or `wrong_dimension`, `out` has no segments. Returns `before_history` also
  /// if `from` is before a live stream's first waypoint, where `sample` returns `holding`. If
  /// `from` > `to`, returns `settled` or `provisional` with no segments, or with the one that
  /// contains both. The segments are the curve as solved, before DimensionKinds::normalise; their
  /// acceleration steps are those of the normalised curve, which readers see. The step at the left
  /// end of the oldest segment on the board is empty, because the segment before it is no longer
  /// there. Allocates if `out` must grow.
  [[nodiscard]] SampleStatus snapshot(Time from, Time to, Snapshot& out);

  /// The stream's limits; empty if it has none. They never change.
  [[nodiscard]] const MotionLimits& limits() const noexcept;

  /// Compares a sample with the stream's limits: returns the place nearest to a limit, or farthest
  /// beyond one. A ratio above 1 exceeds the limit; `u` is 0. O(D), allocates nothing.
  [[nodiscard]] Excess excess(const State& sampled) const noexcept;

  /// The progress of the curve; empty if there is no revision yet, or if the writer overtook every
  /// try.
  [[nodiscard]] std::optional<CurveProgress> progress() const noexcept;

  /// Time of the oldest knot that the board keeps; empty if there is none yet, or if the writer
  /// overtook every try.
  [[nodiscard]] std::optional<Time> first_time() const noexcept;

  /// Sleeps until there is a revision that this reader has not seen, for programs that need not
  /// spin.
  [[nodiscard]] WaitStatus wait(Time timeout) noexcept;

  /// Which writers live. System calls: do not use it in a control loop. A writer counts as alive if
  /// no file descriptor is left to find out.
  [[nodiscard]] Alive alive() const noexcept;

  /// The properties that the producer set. names() and units() allocate.
  [[nodiscard]] StreamClock clock() const noexcept;
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] std::vector<std::string> units() const;
  [[nodiscard]] DimensionKinds kinds() const;

  /// Whether the region's pages are locked into memory: best effort, see RLIMIT_MEMLOCK.
  [[nodiscard]] bool is_memory_locked() const noexcept;

 private:
  friend struct ipc::Internals;
  [[nodiscard]] SampleStatus follow(Time host, const StateRef& out, bool is_executed) noexcept;
  [[nodiscard]] SampleStatus follow_seen(Time host, const StateRef& out, bool is_executed) noexcept;
  [[nodiscard]] SampleStatus sample_point(const ipc::LawPoint& point, const StateRef& out,
                                          bool is_executed) noexcept;
  [[nodiscard]] std::uint64_t follow_many(std::span<const Time> times,
                                          const SampleBlock& out) noexcept;
  struct Impl;
  std::unique_ptr<Impl> impl_;
  ipc::Sampler* sampler_;  ///< inside impl_
  bool follows_law_;
  LawRate rate_{};
  std::size_t dimensions_;
};

}  // namespace splinecast
