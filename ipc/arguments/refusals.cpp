#include "ipc/arguments/refusals.hpp"

#include <algorithm>
#include <climits>
#include <cstring>
#include <string>
#include <utility>

#include "ipc/arguments/guard.hpp"
#include "ipc/arguments/structs.hpp"

namespace splinecast::ipc {
namespace {

splinecast_refusal refusal_of(const ItemRefusal& refusal) noexcept {
  splinecast_refusal out{
      .item = refusal.item,
      .time = refusal.time ? refusal.time->count() : 0,
      .reason = static_cast<int>(refusal.reason),
      .has_time = refusal.time ? 1 : 0,
      .has_excess = refusal.excess ? 1 : 0,
      .reserved = 0,
      .excess = refusal.excess ? limit_excess_of(*refusal.excess) : splinecast_limit_excess{},
      .by = {}};
  std::memcpy(out.by, refusal.by.data(), std::min(refusal.by.size(), sizeof out.by - 1));
  return out;
}

}  // namespace

splinecast_limit_excess limit_excess_of(const LimitExcess& excess) noexcept {
  return {.item = excess.item,
          .time = excess.time.count(),
          .value = excess.value,
          .limit = excess.limit,
          .dimension = excess.dimension,
          .kind = static_cast<int>(excess.kind),
          .is_refused = excess.is_refused ? 1 : 0};
}

LimitExcess read_excess(const splinecast_limit_excess& given, const char* name) {
  if (given.dimension >= kMaxDimensions) {
    refuse(name, "has dimension " + std::to_string(given.dimension) + ", not 0 to 63");
  }
  return {.item = given.item,
          .is_refused = require_flag(given.is_refused, name),
          .kind = static_cast<LimitKind>(require_choice(given.kind, kLimitKinds, name)),
          .dimension = given.dimension,
          .time = Time(given.time),
          .value = given.value,
          .limit = given.limit};
}

ItemRefusal read_refusal(const splinecast_refusal& given) {
  const int reason = require_choice(given.reason, kRefusals, "refusal->reason");
  ItemRefusal refusal{.item = given.item, .reason = static_cast<Refusal>(reason)};
  if (reason == 0) refuse("refusal->reason", "is 0");
  if (require_flag(given.has_time, "refusal->has_time")) refusal.time = Time(given.time);
  if (require_flag(given.has_excess, "refusal->has_excess")) {
    refusal.excess = read_excess(given.excess, "refusal->excess");
  }
  refusal.by.assign(given.by, strnlen(given.by, sizeof given.by));
  return refusal;
}

void RefusalQueue::require_room(const splinecast_refusals* out) {
  constexpr std::size_t kFirst = sizeof(splinecast_refusal);
  require_size(out, sizeof(splinecast_refusals), "out");
  const std::size_t size = out->item_size;
  if (size < kFirst || size % alignof(splinecast_refusal) != 0 || size > kMaxText) {
    refuse("out->item_size", "is " + std::to_string(size) + ", not " + std::to_string(kFirst));
  }
  if (out->capacity == 0 && out->items == nullptr) return;
  require_pointer(out->items, "out->items");
  if (out->capacity > static_cast<std::size_t>(PTRDIFF_MAX) / size) {
    refuse("out->capacity", "is " + std::to_string(out->capacity) + ", more than memory can hold");
  }
}

int RefusalQueue::write(splinecast_refusals* out) {
  const std::size_t count = std::min(out->capacity, found_.items.size() - next_);
  auto* to = reinterpret_cast<std::byte*>(out->items);
  for (std::size_t i = 0; i < count; ++i, to += out->item_size) {
    const splinecast_refusal refusal = refusal_of(found_.items[next_ + i]);
    std::fill_n(to, out->item_size, std::byte{});
    std::memcpy(to, &refusal, sizeof refusal);
  }
  next_ += count;
  out->count = count;
  out->missed = std::exchange(found_.missed, 0);
  out->consumed = found_.consumed;
  if (next_ < found_.items.size()) {
    out->consumed = std::min(out->consumed, found_.items[next_].item);
  }
  return static_cast<int>(count);
}

}  // namespace splinecast::ipc
