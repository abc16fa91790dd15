#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "ipc/ring/reader.hpp"

namespace splinecast::ipc {

/// The replacements that wait in a ring. A solver finds one that is due regardless of the items
/// queued before it. Reads each item of the ring once, when it arrives. Allocates only when
/// constructed.
class ReplacementQueue {
 public:
  explicit ReplacementQueue(const WaypointRingReader& ring);

  /// Notes the replacements among the items up to `available`, and drops those before `consumed`,
  /// which have been committed. O(1) per item.
  void note(Word consumed, Word available) noexcept;

  /// Whether no replacement waits.
  [[nodiscard]] bool empty() const noexcept { return first_ == items_.size(); }

  /// The replacement to carry out next, before all items queued before it: the one that takes
  /// effect first, and the newest one of several at the same time. The curve is settled until
  /// `settled_until`, and its newest knot is at `newest`. A replacement at t takes effect at
  /// max(t, settled_until). Returns nothing if each one is after the newest knot. O(replacements).
  [[nodiscard]] std::optional<Word> due(Time settled_until, Time newest) const noexcept;

 private:
  const WaypointRingReader* ring_;
  std::vector<Word> items_;  ///< item numbers of the replacements, ascending
  std::size_t first_ = 0;    ///< the first one that has not been dropped
  Word noted_ = 0;           ///< items before this one have been read
};

}  // namespace splinecast::ipc
