#pragma once

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

namespace [[gnu::visibility("default")]] splinecast {

/// An item that the ring had accepted and the solver refused.
struct ItemRefusal {
  std::uint64_t item = 0;      ///< number of the item: Producer::appended() before its append; of
                               ///< waypoint i of a replacement: appended() before that, + 1 + i
  std::optional<Time> time{};  ///< of the item; unset if the ring has overwritten it
  Refusal reason{};
  std::optional<LimitExcess> excess{};  ///< of `beyond_limits`, unless the board no longer has it
};

/// `item 17 refused: too late (time 123 ns)`; of one beyond a limit also where.
[[nodiscard]] std::string to_string(const ItemRefusal& refusal);

/// `acceleration of dimension 2 (wrist) is 12.5 at 456 ns, limit 10`, with the dimension's name if
/// there is one among these.
[[nodiscard]] std::string in_words(const LimitExcess& excess,
                                   std::span<const std::string> names = {});

/// What a solver has refused since it was asked the last time.
struct Refusals {
  std::vector<ItemRefusal> items{};  ///< in the order of the ring; at most 1,024
  std::uint64_t missed = 0;  ///< further refusals, before these, that the board no longer has
  std::uint64_t consumed =
      0;  ///< items below this number are decided: refused ones are told by now
};

/// Largest magnitudes along a motion, one value per dimension; of a quaternion those of its
/// components' derivatives.
struct MotionPeaks {
  std::vector<double> velocity;      ///< [unit/s]
  std::vector<double> acceleration;  ///< [unit/s²]
  std::vector<double> jerk;          ///< [unit/s³]
};

/// What a replacement would do to the curve.
struct ReplacePreview {
  AppendStatus status{};  ///< what `replace_from` would answer now; if not `accepted`, no more
  bool is_known = false;  ///< a curve stands whose state at t could be read; else no more
  Time begin{};           ///< of the motion: t, or what has settled if a stop is asked for later
  Time duration{};        ///< of the entry onto the waypoints; of a stop, until it rests
  bool enters = false;    ///< there is an entry; else the curve comes to rest from t on
  std::optional<std::size_t> waypoint{};  ///< at which it ends; none: it ends beyond the last one
  std::size_t passed_over = 0;            ///< waypoints that lie before its end
  MotionPeaks entry;                      ///< of the entry, or of the stop instead
  MotionPeaks motion;                     ///< of all from t until the curve rests
  Excess worst{};  ///< where that is nearest to a limit or farthest beyond; `u` is of no use here:
                   ///< it counts from the left end of a segment that is not named. A ratio below 0:
                   ///< there are no limits
};

/// How a replacement goes over from the old motion to the new one.
struct ReplaceOptions {
  /// The entry onto the new waypoints takes at least so long: those before its end are passed over.
  /// 0 or less: to the first one, or, with limits, to the first at which they can be kept. At most
  /// the stream's most interval.
  Time blend{};
};

/// The role that appends waypoints: the one writer of a stream's waypoint ring.
///
/// One thread uses it. Other processes read what it writes; while it lives, no other process can
/// become the producer of the same stream. On a live stream:
///
///     Producer producer("arm", {.dimensions = 7});
///     if (!producer.wait_for_solver(10s)) return 1;
///     // The lead is at least freeze_ahead and (settle + 1) intervals together.
///     const Time begin = MonotonicClock().now() + lead;
///     for (const Row& row : path) {  // their times count from 0
///       const Waypoint waypoint{.time = begin + row.time, .position = row.position};
///       AppendStatus status = producer.append(waypoint);
///       while (status == AppendStatus::full && producer.wait_for_room(10s)) {
///         status = producer.append(waypoint);
///       }
///       if (status != AppendStatus::accepted) return 1;
///     }
///     if (producer.finish({.kind = ConditionKind::halt}) != AppendStatus::accepted) return 1;
///     while (!producer.wait_until_consumed(10s) && producer.solver_alive()) {}
///
/// `accepted` says only that the ring has the item: see refusals().
class Producer {
 public:
  /// Makes the stream, or makes it again if it is finished, or continues it if its producer died
  /// before finishing. A solver takes up a stream that was made again once the old curve has come
  /// to rest: on a live one, call wait_for_solver() before choosing times for waypoints. Throws
  /// StreamBusy if it has a living producer; BadRequest for a name or options that can be no
  /// stream's, a start condition whose values do not fit the dimensions among them, and if the
  /// options contradict a stream that is continued; BadRegion if shared memory is full or the files
  /// of that name cannot be used.
  Producer(std::string stream, ProducerOptions options);
  Producer(Producer&&) noexcept;
  Producer& operator=(Producer&&) noexcept;
  ~Producer();

  /// Appends a waypoint. O(D), never blocks or allocates; one system call where it wakes a sleeping
  /// solver. Until a solver has come each call looks for one, which is a system call and may
  /// allocate. `full` asks to try again later.
  [[nodiscard]] AppendStatus append(const Waypoint& waypoint) noexcept;

  /// Replaces all that lies behind time t by these waypoints, from none upwards, as one revision:
  /// the curve goes on from its state at t by an entry, as ReplaceOptions has it, or, without a
  /// waypoint, comes to rest. With waypoints, `t` must not lie before earliest() nor, on a live
  /// stream, before now, else `too_late`; the waypoints must be later than it, and fit into the
  /// ring besides what it keeps free for stops. On a stream that has no waypoint yet they start it,
  /// as appended ones do. O(D) per waypoint; otherwise as append.
  ///
  /// Without waypoints it is a stop, which is never too late: a t that has settled means as soon as
  /// possible. The solver's next step carries it out at its settled_until, or at t if that is
  /// later, whatever is queued before it; and that step comes after one sweep, or one wake, at
  /// most. A stop at a t behind the newest knot waits for its turn, and at the latest for
  /// settled_until to reach t. A ring of 16 items or more keeps room for stops and for `finish`:
  /// when it is full of waypoints it takes them.
  [[nodiscard]] AppendStatus replace_from(Time t, std::span<const Waypoint> waypoints,
                                          const ReplaceOptions& options = {}) noexcept;

  /// What `replace_from` with these arguments would do, without changing anything: how long the
  /// entry takes, the largest velocities, accelerations and jerks, and what would be passed over.
  /// Of a stop: how long it takes from t, or from earliest() if that is later. As the solver would
  /// plan it now: what is published meanwhile, and the time that passes, may change it. O(n·K·D),
  /// and reads the board; no system call but the search for a solver, as in append. Allocates: the
  /// second form reuses its memory. From the producer's thread. Throws std::bad_alloc only.
  [[nodiscard]] ReplacePreview preview_replace(Time t, std::span<const Waypoint> waypoints,
                                               const ReplaceOptions& options = {});
  void preview_replace(Time t, std::span<const Waypoint> waypoints, const ReplaceOptions& options,
                       ReplacePreview& out);

  /// Says in which state the stream starts, before its first waypoint, which must be later:
  /// velocity and acceleration have one value per dimension. Otherwise as append.
  [[nodiscard]] AppendStatus start_from(const Instant& state) noexcept;

  /// The earliest time that may still be changed: of a live stream what its solver has settled, as
  /// last published; min() of a recorded one, and while no solver has published. O(1); until a
  /// solver has come it looks for one, as append does.
  [[nodiscard]] Time earliest() noexcept;

  /// Ends the stream at its last waypoint; a live one at rest there. The last waypoint is the last
  /// one that the solver does not refuse: see refusals(). If that knot is frozen already, the stop
  /// runs and an entry leads back to it. Throws BadRequest if the condition's values do not fit the
  /// dimensions or ask for motion in a quaternion's, or if a stream cannot meet it: is_online()
  /// must hold, and on a live stream is_at_rest(); otherwise as append.
  [[nodiscard]] AppendStatus finish(const Condition& end);

  /// What the solver has refused since the last call, of the items that this producer appended:
  /// `accepted` says only that the ring has an item. All is known of an item once
  /// `Refusals::consumed` is above its number. The board keeps the last 1,024 refusals; `missed`
  /// counts those that were overwritten before, and is 0 as long as at most 1,024 items are
  /// consumed between two calls. O(1) if nothing was published since, else O(refusals); reads the
  /// board only, no system call but the search for a solver, as in append. Allocates in the result
  /// only: the second form reuses its memory. From the producer's thread.
  [[nodiscard]] Refusals refusals();
  void refusals(Refusals& out);

  /// Waits until a solver has taken the stream up. Returns false after the timeout.
  [[nodiscard]] bool wait_for_solver(Time timeout);

  /// Waits until the ring has room for a waypoint, or until the solver has consumed everything.
  /// Returns false after the timeout. Look at solver_alive() before waiting again.
  [[nodiscard]] bool wait_for_room(Time timeout);
  [[nodiscard]] bool wait_until_consumed(Time timeout);

  /// Whether a solver process lives; true where no descriptor is left to look with. System calls.
  [[nodiscard]] bool solver_alive() const;

  /// Items appended and, of these, consumed by the solver.
  [[nodiscard]] std::uint64_t appended() const noexcept;
  [[nodiscard]] std::uint64_t consumed() const noexcept;

  /// The stream's random number, the same in both of its regions.
  [[nodiscard]] std::uint64_t stream_id() const noexcept;

  /// Whether the ring held items already when this producer was made: of one that died, or was
  /// destroyed, before finishing.
  [[nodiscard]] bool continues() const noexcept;
  /// The time that the next waypoint must be later than: that of the newest item, whichever
  /// producer appended it; 0 while there is none.
  [[nodiscard]] Time last_time() const noexcept;

  /// Whether the region's pages are locked into memory: best effort, see RLIMIT_MEMLOCK.
  [[nodiscard]] bool is_memory_locked() const noexcept;

  /// Removes the stream's waypoint region: for a stream that no solver ever took up. The producer
  /// is of no more use; destroy it. System calls.
  void withdraw() noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace splinecast
