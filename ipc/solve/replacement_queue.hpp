#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "ipc/ring/reader.hpp"

namespace splinecast::ipc {

/// The replacements that wait in a ring, so that a solver finds one that is due behind whatever is
/// queued before it. Each item of the ring is looked at once, when it has come. Allocates when made
/// only.
class ReplacementQueue {
 public:
  explicit ReplacementQueue(const WaypointRingReader& ring);

  /// Notes the replacements among the items up to `available`, and forgets those before `consumed`,
  /// which have been committed. O(1) per item.
  void note(Word consumed, Word available) noexcept;

  /// Whether none waits.
  [[nodiscard]] bool empty() const noexcept { return first_ == items_.size(); }

  /// The replacement to carry out next, before all that is queued before it: of those that apply
  /// to a curve that is settled until `settled_until` and whose newest knot is at `newest`, the
  /// last one of those with the earliest effect. A replacement with waypoints takes effect at its
  /// time t, which must not have settled; a stop, which has none, at max(t, settled_until). Nothing
  /// is found while all of them lie behind the newest knot, or are too late. O(replacements).
  [[nodiscard]] std::optional<Word> due(Time settled_until, Time newest) const noexcept;

 private:
  const WaypointRingReader* ring_;
  std::vector<Word> items_;  ///< their numbers, ascending
  std::size_t first_ = 0;    ///< the first one that is not forgotten
  Word noted_ = 0;           ///< items before it have been looked at
};

}  // namespace splinecast::ipc
