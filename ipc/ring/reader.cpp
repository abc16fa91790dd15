#include "ipc/ring/reader.hpp"

#include "ipc/ring/item_words.hpp"

namespace splinecast::ipc {

WaypointRingReader::WaypointRingReader(std::span<const std::byte> region,
                                       const RingLayout& layout) noexcept
    : layout_(layout),
      control_(words_at(region, layout.control, kRingControlWords)),
      items_(words_at(region, layout.items, layout.capacity * words_per_item(layout))) {}

void WaypointRingReader::copy(Word i, RingItem& out) const noexcept {
  const std::size_t stride = words_per_item(layout_);
  const auto words = items_.subspan((i & (layout_.capacity - 1)) * stride, stride);
  const Word kind = load(words[kItemKind], std::memory_order_acquire);
  out.kind = static_cast<ItemKind>(kind & kKindMask);
  out.has_velocity = (kind & kHasVelocity) != 0;
  out.has_acceleration = (kind & kHasAcceleration) != 0;
  out.condition = static_cast<ConditionKind>((kind >> kConditionShift) & kKindMask);
  out.commander = static_cast<std::uint8_t>((kind >> kCommanderShift) & kKindMask);
  out.place = static_cast<std::uint8_t>((kind >> kPlaceShift) & kKindMask);
  out.count = static_cast<std::uint32_t>(kind >> kCountShift);
  out.time = to_time(load(words[kItemTime], std::memory_order_acquire));
  out.blend = out.kind == ItemKind::replace && out.count > 0
                  ? to_time(load(words[kItemValues], std::memory_order_acquire))
                  : Time::zero();
  const bool is_bare = out.kind == ItemKind::waypoint && !out.has_velocity && !out.has_acceleration;
  const std::size_t values = is_bare ? layout_.dimensions : out.values.size();
  load_values(std::span(out.values).first(values), &words[kItemValues]);
}

ItemKind WaypointRingReader::kind(Word i) const noexcept {
  const Word& word = items_[(i & (layout_.capacity - 1)) * words_per_item(layout_) + kItemKind];
  return static_cast<ItemKind>(load(word, std::memory_order_acquire) & kKindMask);
}

bool WaypointRingReader::is_stop(Word i) const noexcept {
  const Word& word = items_[(i & (layout_.capacity - 1)) * words_per_item(layout_) + kItemKind];
  const Word kind = load(word, std::memory_order_acquire);
  return (kind & kKindMask) == static_cast<Word>(ItemKind::replace) && kind >> kCountShift == 0;
}

Time WaypointRingReader::time(Word i) const noexcept {
  const Word& word = items_[(i & (layout_.capacity - 1)) * words_per_item(layout_) + kItemTime];
  return to_time(load(word, std::memory_order_acquire));
}

bool WaypointRingReader::observe(Word i, RingItem& out) const noexcept {
  copy(i, out);
  return is_kept(i);
}

std::optional<Time> WaypointRingReader::observe_time(Word i) const noexcept {
  if (i >= written()) return std::nullopt;
  const Time at = time(i);
  return is_kept(i) ? std::optional(at) : std::nullopt;
}

/// O2: whether the words of item i that were loaded are valid.
bool WaypointRingReader::is_kept(Word i) const noexcept {
  const Word next = i + layout_.capacity;  // the item that will overwrite it
  return load(control_[kWritten], std::memory_order_relaxed) < next &&
         load(control_[kClaimed], std::memory_order_relaxed) <= next;
}

Word WaypointRingReader::refused(AppendStatus status) const noexcept {
  return load(control_[kProducerCounters + static_cast<std::size_t>(status)],
              std::memory_order_relaxed);
}

}  // namespace splinecast::ipc
