#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "splinecast/boundary_condition.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/options.hpp"
#include "splinecast/status.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {
struct Internals;
}  // namespace splinecast::ipc

namespace [[gnu::visibility("default")]] splinecast {

/// An item that the ring accepted and the solver refused.
struct ItemRefusal {
  std::uint64_t item = 0;      ///< number of the item: see Producer::last_item()
  std::optional<Time> time{};  ///< of the item; unset if the ring has overwritten it
  Refusal reason{};
  std::optional<LimitExcess> excess{};  ///< for `beyond_limits`, while the board has it
  std::string by{};  ///< for `stopped`: the name of a stopper, while the board has it
};

/// `item 17 refused: too late (time 123 ns)`; `beyond_limits` adds the excess.
[[nodiscard]] std::string to_string(const ItemRefusal& refusal);

/// Describes an excess, with the dimension's name if `names` has one:
/// `acceleration of dimension 2 (wrist) is 12.5 at 456 ns, limit 10`.
[[nodiscard]] std::string in_words(const LimitExcess& excess,
                                   std::span<const std::string> names = {});

/// The items that a solver has refused since the last call of Producer::refusals().
struct Refusals {
  std::vector<ItemRefusal> items{};  ///< in the order of the ring; at most 1,024
  std::uint64_t missed = 0;    ///< older refusals since that call, which the board no longer has
  std::uint64_t consumed = 0;  ///< all refusals of items below this number have been reported
};

/// Largest magnitudes along a motion, one value per dimension; for a quaternion, of the derivatives
/// of its components.
struct MotionPeaks {
  std::vector<double> velocity;      ///< [unit/s]
  std::vector<double> acceleration;  ///< [unit/s²]
  std::vector<double> jerk;          ///< [unit/s³]
};

/// The effect that a replacement would have on the curve.
struct ReplacePreview {
  AppendStatus status{};   ///< what `replace_from` would return now; unless `accepted`, the other
                           ///< members are not valid
  bool is_known = false;   ///< the curve exists and its state at t was read; else the members below
                           ///< are not valid
  Time begin{};            ///< of the motion: t; for a stop at a settled time, settled_until
  Time duration{};         ///< of the entry onto the waypoints, or of the stop
  bool from_rest = false;  ///< whether the motion begins at rest where the stream's time law holds
                           ///< it: see Producer::replace_from
  bool enters = false;     ///< whether there is an entry; else the curve comes to rest from t on
  std::optional<std::size_t> waypoint{};  ///< where the entry ends; unset: it ends beyond the last
                                          ///< waypoint
  std::size_t passed_over = 0;            ///< waypoints before the end of the entry
  MotionPeaks entry;                      ///< of the entry; of the stop if there is no entry
  MotionPeaks motion;                     ///< of the whole motion, from t until the curve rests
  Excess worst{};  ///< the place in `motion` nearest to a limit, or farthest beyond one. `u` has no
                   ///< meaning here: it counts from the left end of a segment that is not given.
                   ///< Ratio below 0: there are no limits
};

/// Where the motion of a replacement begins.
struct ReplacementBegin {
  Time begin{};
  bool from_rest = false;  ///< it begins at rest, where the stream's time law held it
};

/// The transition from the old motion to the new one.
struct ReplaceOptions {
  /// Least duration of the entry onto the new waypoints; waypoints before its end are passed over.
  /// 0 or less: the entry ends at the first waypoint or, with limits, at the first one where they
  /// are kept. At most the longest interval that the stream allows.
  Time blend{};
};

/// What is known of a start state.
struct StartOptions {
  /// The machine was moved since the earlier stream of this name came to rest: the state is not
  /// compared with that end. If the state then has a position only, nothing is written: the machine
  /// rests there, and the first waypoint is compared with that position.
  bool moved = false;
};

/// The role that appends waypoints: the one writer of a stream's waypoint ring.
///
/// One thread uses it. Other processes read what it writes; while it lives, no other process can
/// become the producer of the same stream. On a live stream:
///
///     Producer producer("arm", {.dimensions = 7});
///     if (!producer.wait_for_solver(10s)) return 1;
///     // The lead is at least freeze_ahead + (settle + 1) intervals.
///     const Time begin = MonotonicClock().now() + lead;
///     for (const Row& row : path) {  // their times count from 0
///       const Waypoint waypoint{.time = begin + row.time, .position = row.position};
///       AppendStatus status = producer.append(waypoint);
///       while (status == AppendStatus::full && producer.wait_for_room(10s)) {
///         status = producer.append(waypoint);
///       }
///       if (status != AppendStatus::accepted) return 1;
///     }
///     if (producer.finish() != AppendStatus::accepted) return 1;
///     while (!producer.wait_until_consumed(10s) && producer.solver_alive()) {}
///
/// `accepted` means only that the ring has the item: see outcome() and refusals().
class Producer {
 public:
  /// Creates the stream, creates it again if it is finished, or continues it if its producer died
  /// before finishing. A solver attaches to a recreated stream once the old curve is at rest: on a
  /// live stream, call wait_for_solver() before choosing times for waypoints. Throws StreamBusy if
  /// the stream has a living producer; BadRequest for an invalid name, invalid options (also a
  /// start condition whose values do not fit the dimensions), or options that contradict the stream
  /// that it continues; BadRegion if shared memory is full or the files of that name cannot be
  /// used.
  Producer(std::string stream, ProducerOptions options);
  Producer(Producer&&) noexcept;
  Producer& operator=(Producer&&) noexcept;
  ~Producer();

  /// Appends a waypoint. O(D), never blocks or allocates; one system call if it wakes a sleeping
  /// solver. Until a solver has attached, each call looks for one, which takes a system call and
  /// may allocate. After `full`, retry later.
  ///
  /// The first waypoint of a live stream is compared with the place where an earlier live stream of
  /// this name has left the machine, if its board is there and has the same dimensions and kinds: a
  /// controller that held that place must not be moved in a step. If a motion from rest there
  /// reaches the waypoint at its time within the limits that are given, the stream starts there, by
  /// an entry; this adds a start state to the ring. In a dimension without limits the waypoint must
  /// be there within ProducerOptions::start_tolerance. Else it is refused as `elsewhere`: use
  /// start_from(). The same holds for the first waypoint of replace_from().
  ///
  /// The first waypoint of a producer that continues a live stream, while the motion of the dead
  /// one lasts, may belong to another motion. It continues that one if it is later than its
  /// newest waypoint, and its chord from there keeps the limits, or those that the motion shows.
  /// Else it replaces that motion as soon as possible, as replace_from() with this one waypoint
  /// does; `past` if it is not later than that.
  [[nodiscard]] AppendStatus append(const Waypoint& waypoint) noexcept;

  /// Replaces everything after time t by `waypoints`, which may be empty, as one revision. The
  /// curve continues from its state at t by an entry onto the waypoints, see ReplaceOptions;
  /// without waypoints it comes to rest. With waypoints, `t` must not be before the settled time
  /// nor, on a live stream, before now + freeze_ahead, else `too_late`: see earliest(). The
  /// waypoints must be later than `t` and must fit into the ring, which reserves places for stops.
  /// On a stream that has no waypoints yet, they start it as appended ones do. O(D) per waypoint;
  /// otherwise as append.
  ///
  /// Without t, or with Time::min(), it takes effect as soon as possible. Then only the last
  /// waypoint must be later than that.
  ///
  /// A replacement that is in the ring is never too late: the solver's next step executes it at
  /// settled_until, or at t if that is later, regardless of the items queued before it, and passes
  /// over those of its waypoints that are before. That step comes after at most one wake of the
  /// solver, or one sweep over all streams that it solves. A replacement at a t after the newest
  /// knot waits for its turn in the queue, at most until settled_until reaches t.
  ///
  /// Without waypoints it is a stop, for which any t is early enough. A ring of 16 or more items
  /// accepts stops and `finish` even when it is full of waypoints.
  ///
  /// While the time law of the stream holds it, a stop or a replacement at a t that has settled, or
  /// is at most 10 freeze-aheads after the held time, takes effect where the law holds it, 1 ns
  /// later: what follows begins at rest there,
  /// and the machine stays where it is until the new waypoints move it. So does a stop that is
  /// executed when the law comes to rest. That is certain only if the law has settled at rate 0 at
  /// the solver's step; else the stop or entry is as without a hold. replacement_begin() says
  /// which.
  [[nodiscard]] AppendStatus replace_from(Time t, std::span<const Waypoint> waypoints,
                                          const ReplaceOptions& options = {}) noexcept;
  [[nodiscard]] AppendStatus replace_from(std::span<const Waypoint> waypoints,
                                          const ReplaceOptions& options = {}) noexcept {
    return replace_from(Time::min(), waypoints, options);
  }

  /// The same with waypoints in columns, such as as_waypoints() makes of matrices. Does not
  /// allocate. `wrong_dimension` also if a column does not have D values per time.
  template <std::same_as<Waypoints> Columns>
  [[nodiscard]] AppendStatus replace_from(Time t, const Columns& waypoints,
                                          const ReplaceOptions& options = {}) noexcept {
    return replace_by_columns(t, waypoints, options.blend);
  }
  template <std::same_as<Waypoints> Columns>
  [[nodiscard]] AppendStatus replace_from(const Columns& waypoints,
                                          const ReplaceOptions& options = {}) noexcept {
    return replace_by_columns(Time::min(), waypoints, options.blend);
  }

  /// Computes what `replace_from` with these arguments would do, without changing anything:
  /// duration of the entry, largest velocities, accelerations and jerks, waypoints passed over. For
  /// a stop: its duration from t, or from the earliest time if that is later. The result is what
  /// the solver would plan now: later revisions and the passing of time may change it. O(n·K·D);
  /// reads the board; no system call except the search for a solver, as in append. Allocates; the
  /// second form reuses the memory of `out`. Producer's thread only. Throws std::bad_alloc only.
  [[nodiscard]] ReplacePreview preview_replace(Time t, std::span<const Waypoint> waypoints,
                                               const ReplaceOptions& options = {});
  void preview_replace(Time t, std::span<const Waypoint> waypoints, const ReplaceOptions& options,
                       ReplacePreview& out);

  /// Sets the state in which the stream starts: where the machine is. Call it before the first
  /// waypoint is appended; that waypoint must be later. Velocity and acceleration have one value
  /// per dimension. A state that comes late begins at settled_until. `elsewhere` if an earlier live
  /// stream has left the machine farther away than ProducerOptions::start_tolerance, unless
  /// StartOptions::moved. Otherwise as append.
  [[nodiscard]] AppendStatus start_from(const Instant& state,
                                        const StartOptions& options = {}) noexcept;

  /// The state at rest in which an earlier live stream of this name has left the machine, at the
  /// earliest time at which this stream can start there, for start_from(). Its position is empty if
  /// there was none, its board has been removed or has other dimensions or kinds, its solver may
  /// still move its end, or this stream has started. Valid until the next call of the producer.
  /// System calls; may allocate.
  [[nodiscard]] Instant old_end() noexcept;

  /// Why a first waypoint or start state is `elsewhere`: both positions, the distance, and what to
  /// do. Empty if there is no old end. Throws std::bad_alloc only.
  [[nodiscard]] std::string why_elsewhere(const Waypoint& first);

  /// The earliest time at which a replacement that is sent now takes effect exactly at its own
  /// time: of a live stream the later of the settled time and now + freeze_ahead, plus the longest
  /// pause of its solver in the last second, at least 0.2 ms. The pause is also the time that
  /// replace_from() may come after this call. While a time law holds the stream, no pause is added.
  /// Of a recorded stream the settled time; min() before a solver has published. O(1); until a
  /// solver has attached, looks for one, as append does.
  [[nodiscard]] Time earliest() noexcept;

  /// Where the motion of this producer's last replacement begins, once the solver has taken it, as
  /// long as the board keeps it; else nothing, also if it was refused. O(1) and at most O(refusals
  /// kept); reads the board; no system call except the search for a solver, as in append.
  /// Allocates. Producer's thread only. Throws std::bad_alloc only.
  [[nodiscard]] std::optional<ReplacementBegin> replacement_begin();

  /// The names of the stoppers that hold the stream, by the newest revision: who `stopped` an item.
  /// See Stopper. Reads the board; no system call except the search for a solver, as in append.
  /// Allocates. Producer's thread only. Throws std::bad_alloc only.
  [[nodiscard]] std::vector<std::string> stopped_by();

  /// The time of the stream's clock: of a live stream CLOCK_MONOTONIC, of a stream that follows a
  /// law the law's stream time; 0 for a recorded stream.
  [[nodiscard]] Time now() noexcept;

  /// Ends the stream at its last waypoint, with this boundary condition, by default at rest. A live
  /// stream ends at rest: if the requested end would exceed a limit, the curve slows down on its
  /// path, or ends in another way within limits, as docs/motion-limits.md says. The last waypoint
  /// is the last one that the solver does not refuse: see refusals(). Throws BadRequest if the
  /// condition's values do not fit the dimensions or are not 0 for a quaternion, or if a stream
  /// cannot meet the condition: is_online() must hold, and on a live stream is_at_rest(). Otherwise
  /// as append.
  [[nodiscard]] AppendStatus finish(const Condition& end = {.kind = ConditionKind::halt,
                                                            .value = {}});

  /// Returns the items of this producer that the solver has refused since the last call: `accepted`
  /// means only that the ring has an item. The result for an item is final once
  /// `Refusals::consumed` is above its number. The board keeps the last 1,024 refusals; `missed`
  /// counts those overwritten before they were returned, and is 0 as long as at most 1,024 items
  /// are consumed between two calls. O(1) if nothing was published since the last call, else
  /// O(refusals); reads only the board; no system call except the search for a solver, as in
  /// append. Allocates only in the result; the second form reuses the memory of `out`. Producer's
  /// thread only.
  [[nodiscard]] Refusals refusals();
  void refusals(Refusals& out);

  /// The number of the item of the last call that was accepted: of a waypoint, a start state or the
  /// finish; of a replacement or a stop that of the replacement, whose waypoint i has this number
  /// + 1 + i. A stop that is already in the ring has the number of that one. 0 before the first.
  [[nodiscard]] std::uint64_t last_item() const noexcept;

  /// What became of an item, by the newest revision: `waiting` for a number that was not given yet.
  /// Outcomes are kept on the board: the last 256 that are not those of a waypoint on the spline at
  /// its own time, and the last 1,024 refusals. `forgotten` is an item that may have had an older
  /// one, one that the ring no longer has and of which there is no record, and one that another
  /// solver took, unless there is a record: never a guess. O(outcomes kept); reads the board; no
  /// system call except the search for a solver, as in append. Producer's thread only.
  [[nodiscard]] ItemOutcome outcome(std::uint64_t item) noexcept;

  /// Waits until an outcome is known: neither `waiting` nor `undecided`. Returns the outcome then,
  /// or after the timeout. Check solver_alive() before waiting again.
  [[nodiscard]] ItemOutcome wait_outcome(std::uint64_t item, Time timeout);

  /// Waits until a solver has attached to the stream. Returns false after the timeout.
  [[nodiscard]] bool wait_for_solver(Time timeout);

  /// Waits until the ring has room for a waypoint, or until the solver has consumed everything.
  /// Returns false after the timeout. Check solver_alive() before waiting again.
  [[nodiscard]] bool wait_for_room(Time timeout);
  [[nodiscard]] bool wait_until_consumed(Time timeout);

  /// Whether a solver process lives; true if no file descriptor is left to find out. System calls.
  [[nodiscard]] bool solver_alive() const;

  /// Items appended, and items of these that the solver has consumed.
  [[nodiscard]] std::uint64_t appended() const noexcept;
  [[nodiscard]] std::uint64_t consumed() const noexcept;

  /// The stream's random number, the same in both of its regions.
  [[nodiscard]] std::uint64_t stream_id() const noexcept;

  /// Whether the ring already held items when this producer was created: those of a producer that
  /// died, or was destroyed, before finishing.
  [[nodiscard]] bool continues() const noexcept;
  /// Time of the newest item, of this or an earlier producer; 0 if there is none. The next waypoint
  /// must be later.
  [[nodiscard]] Time last_time() const noexcept;

  /// Whether the region's pages are locked into memory: best effort, see RLIMIT_MEMLOCK.
  [[nodiscard]] bool is_memory_locked() const noexcept;

  /// Removes the stream's waypoint region: for a stream to which no solver ever attached. Destroy
  /// the producer afterwards; it cannot be used. System calls.
  void withdraw() noexcept;

 private:
  friend struct ipc::Internals;
  struct Impl;
  explicit Producer(std::unique_ptr<Impl> impl) noexcept;
  [[nodiscard]] AppendStatus replace_by_columns(Time t, const Waypoints& columns,
                                                Time blend) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace splinecast
