#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <span>

#include "ipc/layout/common_control.hpp"
#include "ipc/layout/ring_control.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/memory/word.hpp"
#include "ipc/ring/item.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// The reading side of a waypoint ring, for the solver and for passive observers. Uses the
/// orderings S1, S2, O1 and O2 of writer.hpp. No function blocks, allocates or stores.
class WaypointRingReader {
 public:
  /// `region` holds a ring of this layout and outlives the reader.
  WaypointRingReader(std::span<const std::byte> region, const RingLayout& layout) noexcept;

  [[nodiscard]] std::size_t dimensions() const noexcept { return layout_.dimensions; }
  [[nodiscard]] std::size_t capacity() const noexcept { return layout_.capacity; }

  /// Items appended so far; S1, or seq_cst for a solver about to sleep.
  [[nodiscard]] Word written(std::memory_order order = std::memory_order_acquire) const noexcept {
    return load(control_[kWritten], order);
  }
  [[nodiscard]] const Word& written_word() const noexcept { return control_[kWritten]; }
  [[nodiscard]] bool retired() const noexcept {
    return load(control_[kRetired], std::memory_order_acquire) != 0;
  }

  /// `written` and `retired`, in one cache line: everything that must be polled while the ring is
  /// idle.
  [[nodiscard]] std::span<const Word, 2> polled() const noexcept { return control_.first<2>(); }

  /// Prefetches the first half of item i, which holds kind, time and position. Loads nothing.
  void prefetch(Word i) const noexcept {
    prefetch_lines(&items_[(i & (layout_.capacity - 1)) * (layout_.stride / sizeof(Word))],
                   layout_.stride / 2);
  }

  /// Copies item i (S2). The item must have been appended, i < written(), and the consumer must not
  /// have released it: every `consumed` that it has stored is at most i.
  void copy(Word i, RingItem& out) const noexcept;

  /// Kind of item i, with the same precondition.
  [[nodiscard]] ItemKind kind(Word i) const noexcept;
  /// Whether item i is a stop, a replacement without waypoints; with the same precondition.
  [[nodiscard]] bool is_stop(Word i) const noexcept;
  /// Time of item i, with the same precondition.
  [[nodiscard]] Time time(Word i) const noexcept;

  /// Copies item i < written() for an observer: the producer does not wait for observers before it
  /// overwrites an item. Returns false if the item has been, or may have been, overwritten (O2);
  /// then `out` is not valid. Wait-free: O(D).
  [[nodiscard]] bool observe(Word i, RingItem& out) const noexcept;

  /// The time of item i, for an observer; empty if the item has been, or may have been,
  /// overwritten, or has not been appended.
  [[nodiscard]] std::optional<Time> observe_time(Word i) const noexcept;

  /// Number of items that the producer itself refused with this status.
  [[nodiscard]] Word refused(AppendStatus status) const noexcept;

 private:
  [[nodiscard]] bool is_kept(Word i) const noexcept;

  RingLayout layout_;
  std::span<const Word> control_;
  std::span<const Word> items_;
};

}  // namespace splinecast::ipc
