#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "ipc/layout/ring_control.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/ring/item.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/options.hpp"
#include "splinecast/state.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

/// The waypoint ring: items from one producer to one solver, over a span of bytes.
///
/// Items are numbered from 0; item i lies at i modulo the capacity. `head` counts the items
/// appended, `tail`, in the solver's region, those consumed; both only grow.
///
/// Orderings of the hand-over:
///
/// P0 claimed.store(relaxed), before a replacement writes its items: how far they go. `head` alone
///    says that the item behind it may be in writing, but not that many are. Relaxed is enough,
///    because each P1 is a release: who sees a word of the replacement sees P0.
/// P1 word.store(release), each. For the solver P2 would do; for an observer it pairs with O1: who
///    sees a word of item i + capacity sees P0, and the P2 that let `head` reach i + capacity.
/// P2 head.store(seq_cst), which is also a release. Pairs with S1: who sees the count sees the
///    words. It comes last, so that a producer who dies before it has appended nothing.
/// S1 head.load(acquire). Pairs with P2.
/// S2 word.load(acquire), each; relaxed would do, as S1 has ordered it and nobody overwrites the
///    item before S3: it is the same function as O1.
/// S3 tail.store(release), when the items have been read. Pairs with P3: the loads of S2 come
///    before the stores of the P1 that overwrite them. Relaxed would let those be seen by S2.
/// P3 tail.load(acquire), before P1. Pairs with S3.
/// O1 word.load(acquire), each: see P1. Keeps O2 behind it.
/// O2 head.load and claimed.load (relaxed), after the copy: item i may be kept iff
///    head < i + capacity and claimed ≤ i + capacity. At head = i + capacity the producer may
///    already be writing the item that takes its place. Relaxed is enough: O1 has ordered both, and
///    nothing after them depends on them. `claimed` never goes back, also not at a takeover: what a
///    dead producer overwrote stays lost.
///
/// Orderings of sleep and wake. The solver stores `sleeping` and then loads `head`; the producer
/// stores `head` and then loads `sleeping`. One of the two must see what the other stored, else the
/// solver sleeps on beside an item that nobody wakes it for. All four are seq_cst: release and
/// acquire let each load pass the store before it, on x86 as well. The solver sleeps only if `head`
/// is still the one up to which it has consumed, and the kernel compares `head` once more.
///
/// `retired` is stored with release and loaded with acquire: nothing depends on more than the word
/// itself. The counters of refusals are relaxed: each is a number of its own.
namespace splinecast::ipc {

/// Items that waypoints leave free in a ring, for stops and a finish: these must not wait until the
/// board has room for what is queued before them.
[[nodiscard]] constexpr std::size_t control_reserve(std::size_t capacity) noexcept {
  constexpr std::size_t kMost = 4;
  constexpr std::size_t kShare = 16;
  return std::min(kMost, capacity / kShare);
}

/// The producer's side. One thread of one process uses it. No function blocks or allocates.
class WaypointRingWriter {
 public:
  /// `region` holds a ring of this layout and outlives the writer. Goes on behind what it holds;
  /// throws BadRegion if its last item has a time that no producer writes.
  WaypointRingWriter(std::span<std::byte> region, const RingLayout& layout,
                     const IngestLimits& limits);

  /// What is known of the solver: items that it has taken, and the time before which it no longer
  /// changes anything, as last published; min() on a recorded stream. At rest nothing is published:
  /// then a live stream's clock says how long it has paused.
  struct Solved {
    Word consumed = 0;
    Time settled_until = Time::min();
    const Clock* clock = nullptr;  ///< of a live stream
  };

  /// Appends a waypoint if its form is right and there is room besides control_reserve. O(D),
  /// wait-free.
  [[nodiscard]] AppendStatus append(const Waypoint& waypoint, const Solved& solved) noexcept;

  /// Replaces all that lies behind t: `waypoints`, which may be none, must be later than it, and
  /// together with the replacement itself fit into the ring besides control_reserve. One store of
  /// `head` makes all of it visible. O(D) per waypoint. The entry onto them takes at least `blend`:
  /// a negative one means 0, one beyond the most interval is `too_far_apart`. Without waypoints it
  /// is a stop, for which there is the reserve. A t that has settled means the earliest time
  /// possible; a stop that repeats the newest item, a stop that still waits, at the same time or
  /// later takes no item.
  [[nodiscard]] AppendStatus replace_from(Time t, std::span<const Waypoint> waypoints,
                                          const Solved& solved, Time blend = {}) noexcept;

  /// What `replace_from` would answer, of a stop as well. Changes nothing.
  [[nodiscard]] AppendStatus check_replacement(Time t, std::span<const Waypoint> waypoints,
                                               const Solved& solved,
                                               Time blend = {}) const noexcept;

  /// Says in which state the stream starts: before its first waypoint, which must be later.
  [[nodiscard]] AppendStatus start_from(const Instant& state, const Solved& solved) noexcept;

  /// Appends the end of the stream. The condition's values must have been checked.
  [[nodiscard]] AppendStatus finish(const Condition& end, const Solved& solved) noexcept;

  /// Items appended so far.
  [[nodiscard]] Word head() const noexcept { return head_; }
  [[nodiscard]] bool finished() const noexcept { return finished_; }

  /// The time that the next waypoint must be later than, once there is one.
  [[nodiscard]] Time last_time() const noexcept { return last_time_; }

  /// The word that waiting solvers watch.
  [[nodiscard]] const Word& head_word() const noexcept { return control_[kHead]; }

  /// Says that the region is of no more use.
  void retire() noexcept;

 private:
  [[nodiscard]] AppendStatus check_form(const Waypoint& waypoint) const noexcept;
  [[nodiscard]] AppendStatus check(const Waypoint& waypoint, const Solved& solved) const noexcept;
  [[nodiscard]] bool has_room(Word items, const Solved& solved, std::size_t free) const noexcept {
    return head_ - solved.consumed + items + free <= layout_.capacity;
  }
  [[nodiscard]] bool repeats_stop(Time from, const Solved& solved) const noexcept;
  [[nodiscard]] bool is_past(Time time, const Solved& solved) const noexcept;
  [[nodiscard]] bool follows_pause(Time time, const Solved& solved) const noexcept;
  [[nodiscard]] static Time effect_of_stop(Time t, const Solved& solved) noexcept;
  [[nodiscard]] AppendStatus check_stop(Time t, const Solved& solved) const noexcept;
  [[nodiscard]] AppendStatus stop_from(Time t, const Solved& solved) noexcept;
  void claim(Word items) noexcept;
  [[nodiscard]] std::span<Word> item_words(Word index) const noexcept;
  void put_item(Word index, Word kind_and_flags, const Waypoint& values) noexcept;
  void publish(Word items, Time last) noexcept;
  [[nodiscard]] AppendStatus counted(AppendStatus status) noexcept;

  RingLayout layout_;
  IngestLimits limits_;
  std::span<Word> control_;
  std::span<Word> items_;
  Word head_ = 0;
  bool finished_ = false;
  bool has_last_ = false;
  bool ends_with_stop_ = false;  ///< the newest item is a stop
  Time last_time_{};
};

}  // namespace splinecast::ipc
