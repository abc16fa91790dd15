#include "splinecast/ipc/waypoint_ring.hpp"

#include <algorithm>
#include <cstdint>

namespace splinecast::ipc {
namespace {

// Word kItemKind of an item.
constexpr Word kKindMask = 0xff;
constexpr Word kHasVelocity = 1U << 8;
constexpr Word kHasAcceleration = 1U << 9;
constexpr unsigned kConditionShift = 16;

std::size_t words_per_item(const RingLayout& layout) noexcept {
  return layout.stride / sizeof(Word);
}

void put_values(std::span<Word> words, std::span<const double> values) noexcept {
  for (std::size_t d = 0; d < values.size(); ++d) {
    store(words[d], to_word(values[d]), std::memory_order_release);
  }
}

bool fits(std::span<const double> values, std::size_t dimensions) noexcept {
  return values.empty() || values.size() == dimensions;
}

}  // namespace

bool is_finite(std::span<const double> values) noexcept {
  return std::ranges::all_of(values, core::is_usable);
}

WaypointRingWriter::WaypointRingWriter(std::span<std::byte> region, const RingLayout& layout,
                                       const IngestLimits& limits)
    : layout_(layout),
      limits_(limits),
      control_(words_at(region, layout.control, kControlLines * kSeparation / sizeof(Word))),
      items_(words_at(region, layout.items, layout.capacity * words_per_item(layout))),
      head_(load(control_[kHead], std::memory_order_relaxed)) {
  // Look back for the newest waypoint: a producer's last items are waypoints, then a finish.
  const WaypointRingReader past(region, layout);
  RingItem item(layout.dimensions);
  for (Word back = 1; back <= std::min<Word>(head_, layout.capacity) && !has_last_; ++back) {
    past.copy(head_ - back, item);
    finished_ = finished_ || item.kind == ItemKind::finish;
    has_last_ = item.kind == ItemKind::waypoint;
    last_time_ = item.time;
  }
}

AppendStatus WaypointRingWriter::check(const core::Waypoint& waypoint) const noexcept {
  const std::size_t dimensions = layout_.dimensions;
  if (finished_) return AppendStatus::finished;
  if (waypoint.position.size() != dimensions || !fits(waypoint.velocity, dimensions) ||
      !fits(waypoint.acceleration, dimensions)) {
    return AppendStatus::wrong_dimension;
  }
  if (!is_finite(waypoint.position) || !is_finite(waypoint.velocity) ||
      !is_finite(waypoint.acceleration)) {
    return AppendStatus::not_finite;
  }
  if (!is_time_in_range(waypoint.time)) return AppendStatus::too_far_apart;
  if (!has_last_) return AppendStatus::accepted;
  return judge_interval(waypoint.time - last_time_, limits_);
}

AppendStatus WaypointRingWriter::append(const core::Waypoint& waypoint, Word consumed) noexcept {
  AppendStatus status = check(waypoint);
  if (status == AppendStatus::accepted && head_ - consumed >= layout_.capacity) {
    status = AppendStatus::full;
  }
  if (status == AppendStatus::accepted) {
    put_item(static_cast<Word>(ItemKind::waypoint), waypoint.time, waypoint.position,
             waypoint.velocity, waypoint.acceleration);
    has_last_ = true;
    last_time_ = waypoint.time;
  } else {
    count(status);
  }
  return status;
}

AppendStatus WaypointRingWriter::finish(const core::Condition& end, Word consumed) noexcept {
  if (finished_) return AppendStatus::finished;
  if (head_ - consumed >= layout_.capacity) return AppendStatus::full;
  const Word kind = static_cast<Word>(ItemKind::finish) | static_cast<Word>(end.kind)
                                                              << kConditionShift;
  const bool is_velocity = end.kind == core::ConditionKind::velocity;
  const std::span<const double> value(end.value);
  put_item(kind, last_time_, {}, is_velocity ? value : std::span<const double>{},
           is_velocity ? std::span<const double>{} : value);
  finished_ = true;
  return AppendStatus::accepted;
}

void WaypointRingWriter::put_item(Word kind_and_flags, core::Time time,
                                  std::span<const double> position,
                                  std::span<const double> velocity,
                                  std::span<const double> acceleration) noexcept {
  const std::size_t stride = words_per_item(layout_);
  const auto words = items_.subspan((head_ & (layout_.capacity - 1)) * stride, stride);
  const Word flags =
      (velocity.empty() ? 0 : kHasVelocity) | (acceleration.empty() ? 0 : kHasAcceleration);
  store(words[kItemKind], kind_and_flags | flags, std::memory_order_release);
  store(words[kItemTime], to_word(time), std::memory_order_release);
  const auto values = words.subspan(kItemValues);
  put_values(values, position);
  put_values(values.subspan(layout_.dimensions), velocity);
  put_values(values.subspan(2 * layout_.dimensions), acceleration);
  ++head_;
  // seq_cst, not only release: the producer loads `sleeping` next, and a solver about to sleep
  // stores `sleeping` and then loads this word. One of the two must see the other's store.
  store(control_[kHead], head_, std::memory_order_seq_cst);
}

void WaypointRingWriter::count(AppendStatus status) noexcept {
  Word& counter = control_[kProducerCounters + static_cast<std::size_t>(status)];
  store(counter, load(counter, std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

void WaypointRingWriter::retire() noexcept {
  store(control_[kRetired], 1, std::memory_order_release);
}

WaypointRingReader::WaypointRingReader(std::span<const std::byte> region,
                                       const RingLayout& layout) noexcept
    : layout_(layout),
      control_(words_at(region, layout.control, kControlLines * kSeparation / sizeof(Word))),
      items_(words_at(region, layout.items, layout.capacity * words_per_item(layout))) {}

void WaypointRingReader::copy(Word i, RingItem& out) const noexcept {
  const std::size_t stride = words_per_item(layout_);
  const auto words = items_.subspan((i & (layout_.capacity - 1)) * stride, stride);
  const Word kind = load(words[kItemKind], std::memory_order_acquire);
  out.kind = static_cast<ItemKind>(kind & kKindMask);
  out.has_velocity = (kind & kHasVelocity) != 0;
  out.has_acceleration = (kind & kHasAcceleration) != 0;
  out.condition = static_cast<core::ConditionKind>((kind >> kConditionShift) & kKindMask);
  out.time = to_time(load(words[kItemTime], std::memory_order_acquire));
  for (std::size_t v = 0; v < out.values.size(); ++v) {
    out.values[v] = to_double(load(words[kItemValues + v], std::memory_order_acquire));
  }
}

bool WaypointRingReader::observe(Word i, RingItem& out) const noexcept {
  copy(i, out);
  return head() - i < layout_.capacity;
}

Word WaypointRingReader::refused(AppendStatus status) const noexcept {
  return load(control_[kProducerCounters + static_cast<std::size_t>(status)],
              std::memory_order_relaxed);
}

}  // namespace splinecast::ipc
