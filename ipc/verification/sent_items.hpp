#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "ipc/memory/word.hpp"
#include "ipc/ring/item.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

/// Consecutive items that were sent to a stream, and which of them the solver took. Allocates as it
/// grows. One thread uses it.
class SentItems {
 public:
  /// `first`: the number of the first item; 0 for all items of the stream.
  explicit SentItems(std::size_t dimensions, Word first = 0)
      : dimensions_(dimensions), first_(first) {}

  [[nodiscard]] std::size_t dimensions() const noexcept { return dimensions_; }

  /// The number of the first item.
  [[nodiscard]] Word first() const noexcept { return first_; }
  /// The number after that of the last item.
  [[nodiscard]] Word size() const noexcept { return first_ + items_.size(); }
  [[nodiscard]] bool has(Word item) const noexcept { return item >= first_ && item < size(); }

  /// Adds the next item, with a copy of its values. A start state has position, velocity and
  /// acceleration; a replacement has only a time; a piece of a law has its end rate, length and
  /// request in these places, and `count` pieces after it.
  void add(ItemKind kind, const Waypoint& values, std::uint32_t count = 0);

  /// Notes that the solver refused an item. Ignores unknown items.
  void refuse(Word item) noexcept;

  [[nodiscard]] ItemKind kind(Word item) const noexcept { return items_[item - first_].kind; }

  /// Whether an item is known, of this kind, and was not refused. O(1).
  [[nodiscard]] bool is_taken(Word item, ItemKind kind) const noexcept {
    return has(item) && at(item).kind == kind && !at(item).is_refused;
  }

  /// The first item from `from` on and before `end` that is of this kind and was not refused;
  /// nothing if there is none.
  [[nodiscard]] std::optional<Word> find(ItemKind kind, Word from, Word end) const noexcept;

  /// Of a piece of a law: the number of pieces of its plan after it.
  [[nodiscard]] std::uint32_t count(Word item) const noexcept { return at(item).count; }

  /// An item's values: a view, valid until the next `add`.
  [[nodiscard]] Waypoint waypoint(Word item) const noexcept;

 private:
  struct Item {
    ItemKind kind;
    bool is_refused = false;
    bool has_velocity = false;
    bool has_acceleration = false;
    std::uint32_t count = 0;
    Time time{};
    std::size_t values = 0;  ///< index of its first value
  };
  [[nodiscard]] const Item& at(Word item) const noexcept { return items_[item - first_]; }

  std::size_t dimensions_;
  Word first_;
  std::vector<Item> items_;
  std::vector<double> values_;
};

}  // namespace splinecast::ipc
