#include "ipc/verification/sent_items.hpp"

#include <algorithm>

namespace splinecast::ipc {

void SentItems::add(ItemKind kind, const Waypoint& values) {
  items_.push_back({.kind = kind,
                    .has_velocity = !values.velocity.empty(),
                    .has_acceleration = !values.acceleration.empty(),
                    .time = values.time,
                    .values = values_.size()});
  for (const auto part : {values.position, values.velocity, values.acceleration}) {
    values_.insert(values_.end(), part.begin(), part.end());
  }
}

void SentItems::refuse(Word item) noexcept {
  if (item < items_.size()) items_[item].is_refused = true;
}

std::optional<Word> SentItems::find(ItemKind kind, Word from, Word end) const noexcept {
  for (Word item = from; item < std::min<Word>(end, size()); ++item) {
    if (is_taken(item, kind)) return item;
  }
  return std::nullopt;
}

Waypoint SentItems::waypoint(Word item) const noexcept {
  const Item& at = items_[item];
  auto rest = std::span(values_).subspan(at.values);
  const auto take = [&](bool is_given) {
    const auto part = rest.first(is_given ? dimensions_ : 0);
    rest = rest.subspan(part.size());
    return part;
  };
  Waypoint waypoint{.time = at.time};
  waypoint.position = take(at.kind != ItemKind::replace && at.kind != ItemKind::finish);
  waypoint.velocity = take(at.has_velocity);
  waypoint.acceleration = take(at.has_acceleration);
  return waypoint;
}

}  // namespace splinecast::ipc
