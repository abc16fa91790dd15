#include "ipc/verification/sent_items.hpp"

#include <algorithm>

namespace splinecast::ipc {

void SentItems::add(ItemKind kind, const Waypoint& values, std::uint32_t count) {
  items_.push_back({.kind = kind,
                    .has_velocity = !values.velocity.empty(),
                    .has_acceleration = !values.acceleration.empty(),
                    .count = count,
                    .time = values.time,
                    .values = values_.size()});
  for (const auto part : {values.position, values.velocity, values.acceleration}) {
    values_.insert(values_.end(), part.begin(), part.end());
  }
}

void SentItems::refuse(Word item) noexcept {
  if (has(item)) items_[item - first_].is_refused = true;
}

std::optional<Word> SentItems::find(ItemKind kind, Word from, Word end) const noexcept {
  for (Word item = std::max(from, first_); item < std::min<Word>(end, size()); ++item) {
    if (is_taken(item, kind)) return item;
  }
  return std::nullopt;
}

Waypoint SentItems::waypoint(Word item) const noexcept {
  const Item& found = at(item);
  auto rest = std::span(values_).subspan(found.values);
  const auto take = [&](bool is_given) {
    const auto part = rest.first(is_given ? dimensions_ : 0);
    rest = rest.subspan(part.size());
    return part;
  };
  Waypoint waypoint{.time = found.time};
  waypoint.position = take(found.kind != ItemKind::replace && found.kind != ItemKind::finish);
  waypoint.velocity = take(found.has_velocity);
  waypoint.acceleration = take(found.has_acceleration);
  return waypoint;
}

}  // namespace splinecast::ipc
