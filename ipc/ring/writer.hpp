#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/laws/rate_curve.hpp"
#include "ipc/layout/ring_control.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/ring/path.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/options.hpp"
#include "splinecast/state.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

/// The waypoint ring: items from one producer to one solver, over a span of bytes.
///
/// Items are numbered from 0; item i is at i modulo the capacity. `written` counts the items
/// appended, `consumed`, in the solver's region, those consumed; both only grow.
///
/// Orderings of the hand-over:
///
/// P0 claimed.store(relaxed), before a replacement writes its items: the end of these items. An
///    observer that sees only `written` knows that the next item may be partly written, but not
///    that several may be. Relaxed is enough, because each P1 is a release: a process that sees a
///    word of the replacement sees P0.
/// P1 word.store(release), each. For the solver P2 is enough. For an observer, P1 pairs with O1: if
///    the observer sees a word of item i + capacity, it sees P0 and the P2 by which `written`
///    reached i + capacity.
/// P2 written.store(seq_cst), which is also a release. Pairs with S1: a process that sees the count
///    sees the words. P2 comes last: a producer that dies before P2 has appended nothing.
/// S1 written.load(acquire). Pairs with P2.
/// S2 word.load(acquire), each. Relaxed would be enough, because S1 has ordered it and no process
///    overwrites the item before S3. It is acquire because S2 and O1 share one function.
/// S3 consumed.store(release), when the items have been read. Pairs with P3: for any order of P1
///    and S2, the loads of S2 come before the stores of the P1 that overwrite them. With S3 and S2
///    relaxed, S2 could see those stores. With P1 release and S2 acquire, S3 and P3 could be
///    relaxed: an S2 that sees a store of P1 comes after the P3 before that P1, so that this P3
///    cannot have loaded the S3 after that S2.
/// P3 consumed.load(acquire), before P1. Pairs with S3.
/// O1 word.load(acquire), each: see P1. Keeps O2 after it.
/// O2 written.load and claimed.load (relaxed), after the copy: item i may be kept iff
///    written < i + capacity and claimed ≤ i + capacity. At written = i + capacity the producer may
///    already be overwriting item i. Relaxed is enough: O1 has ordered both, and nothing after them
///    depends on them. `claimed` never decreases, not even at a takeover: the items that a dead
///    producer overwrote remain lost.
///
/// Orderings of sleep and wake. The solver stores `sleeping` and then loads `written`; the producer
/// stores `written` and then loads `sleeping`. At least one of the two must see the other's store,
/// else the solver sleeps although there is an item. All four are seq_cst: release and acquire let
/// each load pass the store before it, on x86 as well. The solver sleeps only if `written` still
/// equals the number of items that it has consumed, and the kernel compares `written` once more.
///
/// `retired` is stored with release and loaded with acquire: nothing but the word itself depends on
/// it. The counters of refusals are relaxed: each is independent.
namespace splinecast::ipc {

/// Number of places in a ring that waypoints leave free. They are for stops and a finish, which
/// must not wait until the board has room for the items queued before them.
[[nodiscard]] constexpr std::size_t control_reserve(std::size_t capacity) noexcept {
  constexpr std::size_t kMost = 4;
  constexpr std::size_t kShare = 16;
  return std::min(kMost, capacity / kShare);
}

/// The producer's side. One thread of one process uses it. No function blocks or allocates.
class WaypointRingWriter {
 public:
  /// `region` holds a ring of this layout and outlives the writer. Continues after the items that
  /// are in the ring. Throws BadRegion if the last item's time is out of range: no producer writes
  /// such a time.
  WaypointRingWriter(std::span<std::byte> region, const RingLayout& layout,
                     const IntervalRange& intervals);

  /// What the solver last published: the number of items consumed, and the settled time, before
  /// which the solver changes nothing; min() on a recorded stream. While the curve is at rest, the
  /// solver publishes nothing: then the clock of a live stream gives the length of the pause.
  struct Solved {
    Word consumed = 0;
    Time settled_until = Time::min();
    const Clock* clock = nullptr;  ///< of a live stream
    /// How far ahead of now a time may be. Unset: times are not compared with now.
    std::optional<Time> horizon{};
    /// Until when the solver refuses waypoints as `cannot follow`; max(): it does not. Counts while
    /// it has consumed all items.
    Time refused_until = Time::max();
    Time settle_ahead{};      ///< of the solver of a live stream; 0 if it is not known
    bool is_stopped = false;  ///< a stopper holds the stream
  };

  /// The time of a replacement, or a stop, as soon as possible.
  static constexpr Time kSoonest = Time::min();

  /// The earliest time of a replacement with waypoints, now. Reads the clock of a live stream.
  [[nodiscard]] static Time earliest_replacement(const Solved& solved) noexcept;

  /// Appends a waypoint if it is valid and the ring has room for it and for control_reserve() more
  /// items. O(D), wait-free.
  [[nodiscard]] AppendStatus append(const Waypoint& waypoint, const Solved& solved) noexcept;

  /// Returns what `append` would return. Changes nothing.
  [[nodiscard]] AppendStatus check(const Waypoint& waypoint, const Solved& solved) const noexcept;

  /// Counts the refusal of an item that the caller has refused, and returns its status.
  AppendStatus counted(AppendStatus status) noexcept;

  /// Replaces everything after t. `waypoints` may be empty; else t must not be before
  /// earliest_replacement(), or be kSoonest. They must be later than t, or the last one later than
  /// that time, and must fit into the ring together with the replacement itself and
  /// control_reserve(). One store of
  /// `written` makes all of it visible. O(D) per waypoint. The entry onto the waypoints has at
  /// least the length `blend`: a negative one means 0, one above the longest interval gives
  /// `too_far_apart`. A replacement without waypoints is a stop, which may use the reserve. A stop
  /// at a time that has settled takes effect as early as possible. A stop adds no item if the
  /// newest item is a stop at the same time or earlier that has not been consumed.
  [[nodiscard]] AppendStatus replace_from(Time t, const ReplacementPath& waypoints,
                                          const Solved& solved, Time blend = {}) noexcept;

  /// Returns what `replace_from` would return, also for a stop. Changes nothing.
  [[nodiscard]] AppendStatus check_replacement(Time t, const ReplacementPath& waypoints,
                                               const Solved& solved,
                                               Time blend = {}) const noexcept;

  /// Appends the state in which the stream starts. It must come before the first waypoint, in the
  /// ring and in time.
  [[nodiscard]] AppendStatus start_from(const Instant& state, const Solved& solved) noexcept;

  /// Appends the pieces of a time law's plan, each to its end rate; `commander` and `request` say
  /// whose request they follow. One store of `written` makes all of them visible.
  [[nodiscard]] AppendStatus append_plan(std::span<const core::RatePiece> pieces,
                                         std::uint8_t commander, Word request,
                                         const Solved& solved) noexcept;

  /// Appends the end of the stream. The condition's values must have been checked.
  [[nodiscard]] AppendStatus finish(const Condition& end, const Solved& solved) noexcept;

  /// Items appended so far.
  [[nodiscard]] Word written() const noexcept { return written_; }
  [[nodiscard]] bool finished() const noexcept { return finished_; }

  /// Whether the ring has, or had, a waypoint, a start state or a plan of a law.
  [[nodiscard]] bool has_begun() const noexcept { return has_begun_; }

  /// The time of the newest item, if there is one: the next waypoint must be later.
  [[nodiscard]] Time last_time() const noexcept { return last_time_; }

  /// The word that solvers wait on.
  [[nodiscard]] const Word& written_word() const noexcept { return control_[kWritten]; }

  /// Marks the region as retired.
  void retire() noexcept;

 private:
  AppendStatus refused(AppendStatus status) noexcept;
  [[nodiscard]] AppendStatus check_form(const Waypoint& waypoint) const noexcept;
  [[nodiscard]] AppendStatus check_path(Time t, bool is_soonest, const ReplacementPath& waypoints,
                                        const Solved& solved) const noexcept;
  [[nodiscard]] bool has_room(Word items, const Solved& solved, std::size_t free) const noexcept {
    return written_ - solved.consumed + items + free <= layout_.capacity;
  }
  [[nodiscard]] bool repeats_stop(Time from, const Solved& solved) const noexcept;
  [[nodiscard]] static bool is_too_far_ahead(Time time, const Solved& solved) noexcept;
  [[nodiscard]] bool is_past(Time time, const Solved& solved) const noexcept;
  [[nodiscard]] static bool is_long_past(Time time, const Solved& solved) noexcept;
  [[nodiscard]] bool cannot_follow(Time time, const Solved& solved) const noexcept;
  [[nodiscard]] bool follows_pause(Time time, const Solved& solved) const noexcept;
  [[nodiscard]] static Time effect_of_stop(Time t, const Solved& solved) noexcept;
  [[nodiscard]] AppendStatus check_stop(Time t, const Solved& solved) const noexcept;
  [[nodiscard]] AppendStatus stop_from(Time t, const Solved& solved) noexcept;
  void claim(Word items) noexcept;
  [[nodiscard]] std::span<Word> item_words(Word index) const noexcept;
  void put_item(Word index, Word kind_and_flags, const Waypoint& values) noexcept;
  void publish(Word items, Time last) noexcept;

  RingLayout layout_;
  IntervalRange intervals_;
  std::span<Word> control_;
  std::span<Word> items_;
  Word written_ = 0;
  bool finished_ = false;
  bool has_begun_ = false;
  bool has_last_ = false;
  bool ends_with_stop_ = false;  ///< the newest item is a stop
  Time last_time_{};
};

}  // namespace splinecast::ipc
