#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "ipc/memory/word.hpp"
#include "ipc/ring/item.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

/// The items that were sent to a stream, from its first one, and which of them the solver took.
/// Allocates as it grows. One thread uses it.
class SentItems {
 public:
  explicit SentItems(std::size_t dimensions) : dimensions_(dimensions) {}

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }

  /// Items so far; they are numbered from 0.
  [[nodiscard]] Word size() const noexcept { return items_.size(); }

  /// Adds the next item, with a copy of its values. A start state has position, velocity and
  /// acceleration; a replacement has only a time.
  void add(ItemKind kind, const Waypoint& values);

  /// Notes that the solver refused an item. Ignores unknown items.
  void refuse(Word item) noexcept;

  [[nodiscard]] ItemKind kind(Word item) const noexcept { return items_[item].kind; }

  /// Whether an item is of this kind and was not refused. O(1).
  [[nodiscard]] bool is_taken(Word item, ItemKind kind) const noexcept {
    return items_[item].kind == kind && !items_[item].is_refused;
  }

  /// The first item from `from` on and before `end` that is of this kind and was not refused;
  /// nothing if there is none.
  [[nodiscard]] std::optional<Word> find(ItemKind kind, Word from, Word end) const noexcept;

  /// An item's values: a view, valid until the next `add`.
  [[nodiscard]] Waypoint waypoint(Word item) const noexcept;

 private:
  struct Item {
    ItemKind kind;
    bool is_refused = false;
    bool has_velocity = false;
    bool has_acceleration = false;
    Time time{};
    std::size_t values = 0;  ///< index of its first value
  };
  std::size_t dimensions_;
  std::vector<Item> items_;
  std::vector<double> values_;
};

}  // namespace splinecast::ipc
