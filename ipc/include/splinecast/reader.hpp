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
}  // namespace splinecast::ipc

namespace [[gnu::visibility("default")]] splinecast {

/// Why `Reader::wait` returned.
enum class WaitStatus : std::uint8_t {
  advanced,  ///< there is a revision that this reader had not seen
  timed_out,
  retired,  ///< make a new Reader
};

/// Which of a stream's writers live.
struct Alive {
  bool producer = false;
  bool solver = false;
};

/// How far a stream's curve has come, as of one revision.
struct CurveProgress {
  std::uint64_t revision = 0;
  Time newest{};                ///< time of the newest waypoint, or, while none has followed, of
                                ///< the start state or the replacement
  Time settled_until{};         ///< before it no later revision changes the curve
  bool is_finished = false;     ///< the stream has been finished: no waypoint follows
  std::uint64_t waypoints = 0;  ///< taken by the solver, over the stream's life
  std::uint64_t refused = 0;    ///< items that the solver refused
};

/// The role that reads the curve: what a controller links. Any number of processes read one stream;
/// in each, one thread uses a reader, and every thread may have its own.
class Reader {
 public:
  /// Maps the stream's knot board, waiting for it up to `wait`: looks every 2 ms. Throws BadRequest
  /// for what is no stream's name (1 to 128 of A-Z a-z 0-9 . _ -, no leading dot), NoSuchStream if
  /// no board has come by then, BadRegion if it cannot be used.
  explicit Reader(const std::string& stream, Time wait = Time::zero(), const Trust& trust = {});
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }

  /// Evaluates position, velocity, acceleration and jerk at time `t` into `out`, one value per
  /// dimension in each span; a wrapping position within half a period of 0, a quaternion at unit
  /// length (angular_motion gives its ω and α). Wait-free: no system call, no allocation, no store
  /// to shared memory, whatever the writers do. O(D) where time advances, O(log n + D) at a jump.
  /// Where the status has no values, `out` is left as it was; where a span has another size, as
  /// after attaching to a stream of other dimensions, it is `wrong_dimension`.
  ///
  /// `t` is on clock(): CLOCK_MONOTONIC of a live stream. There a sample counts as executed: if a
  /// later revision changes the curve at or before the latest time sampled, the next sample is
  /// `revised`, once. To look ahead of settled_until() use `preview` or `sample_many`.
  [[nodiscard]] SampleStatus sample(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus sample(Time t, State& out) noexcept { return sample(t, out.ref()); }

  /// The same for a look ahead of what is settled, which does not count as executed.
  [[nodiscard]] SampleStatus preview(Time t, const StateRef& out) noexcept;
  [[nodiscard]] SampleStatus preview(Time t, State& out) noexcept { return preview(t, out.ref()); }

  /// Evaluates the curve at any number of times, increasing or not, all of *one* revision: for
  /// controllers that look ahead, whose horizon must not mix two. Returns that revision, which is
  /// 0 where there was none to be had: then every status says why, and none has values. A look
  /// ahead, which does not count as executed. Wait-free, like `sample`: a bounded number of tries,
  /// each O(N·D) where the times follow each other, and O(N·(log n + D)) at most. A writer that
  /// publishes faster than a try takes leaves `busy`. Where the block's sizes are not those of the
  /// times and of the curve it is `wrong_dimension`.
  std::uint64_t sample_many(std::span<const Time> times, const SampleBlock& out) noexcept;

  /// The time before which what the last sample, or look ahead, saw never changes; the least time
  /// that a curve can have before the first one.
  [[nodiscard]] Time settled_until() const noexcept;

  /// Copies every segment that has a part between `from` and `to` (inclusive), all under one
  /// revision. Returns `settled` or `provisional` for the whole; `before_history`, `no_data`,
  /// `busy`, `retired` or `wrong_dimension` leave `out` without segments. It is `before_history`
  /// also where `from` lies before a live stream's first waypoint, where `sample` says `holding`.
  /// With `from` > `to` it is `settled` or `provisional` without segments, or with the one that
  /// contains both. The segments are the curve as it was solved, before DimensionKinds::normalise;
  /// their acceleration steps are those of what readers see. The step at the left end of the oldest
  /// segment on the board is not known (empty): begin one segment earlier. Allocates if `out` must
  /// grow.
  [[nodiscard]] SampleStatus snapshot(Time from, Time to, Snapshot& out);

  /// The stream's limits; empty if it has none. They never change.
  [[nodiscard]] const MotionLimits& limits() const noexcept;

  /// Marks a sample: where it is nearest to a limit of the stream, or farthest beyond it; a ratio
  /// above 1 is beyond, `u` is 0. O(D), allocates nothing.
  [[nodiscard]] Excess excess(const State& sampled) const noexcept;

  /// How far the curve has come; nothing if there is no revision yet, or if the writer overtook
  /// every try.
  [[nodiscard]] std::optional<CurveProgress> progress() const noexcept;

  /// Time of the oldest knot that the board keeps; nothing if there is none yet, or if the writer
  /// overtook every try.
  [[nodiscard]] std::optional<Time> first_time() const noexcept;

  /// Sleeps until a revision that this reader has not seen, for programs that need not spin.
  [[nodiscard]] WaitStatus wait(Time timeout) noexcept;

  /// Which writers live: system calls, so not inside a control loop. A writer of whom this cannot
  /// be known, because no descriptor is left to look with, counts as alive.
  [[nodiscard]] Alive alive() const noexcept;

  /// What the producer has said of the stream. Names and units allocate.
  [[nodiscard]] StreamClock clock() const noexcept;
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] std::vector<std::string> units() const;
  [[nodiscard]] DimensionKinds kinds() const;

  /// Whether the region's pages are locked into memory: best effort, see RLIMIT_MEMLOCK.
  [[nodiscard]] bool is_memory_locked() const noexcept;

 private:
  friend struct ipc::Internals;
  struct Impl;
  std::unique_ptr<Impl> impl_;
  ipc::Sampler* sampler_;  ///< inside impl_
  std::size_t dimensions_;
};

}  // namespace splinecast
