#include "ipc/solve/replacement_queue.hpp"

#include <algorithm>

#include "ipc/ring/item.hpp"

namespace splinecast::ipc {

ReplacementQueue::ReplacementQueue(const WaypointRingReader& ring) : ring_(&ring) {
  // Touches the memory, so that no step causes a page fault.
  items_.resize(2 * ring.capacity());
  items_.clear();
}

void ReplacementQueue::note(Word consumed, Word available) noexcept {
  while (first_ < items_.size() && items_[first_] < consumed) ++first_;
  if (2 * first_ >= items_.size()) {  // moves at most as many as it drops
    items_.erase(items_.begin(), items_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
  }
  noted_ = std::max(noted_, consumed);
  for (; noted_ < available; ++noted_) {
    if (ring_->kind(noted_) == ItemKind::replace) items_.push_back(noted_);
  }
}

std::optional<Word> ReplacementQueue::due(Time settled_until, Time newest) const noexcept {
  std::optional<Word> found;
  Time earliest = Time::max();
  for (std::size_t i = first_; i < items_.size(); ++i) {
    const Time effect = std::max(ring_->time(items_[i]), settled_until);
    if (effect > std::max(newest, settled_until) || effect > earliest) continue;
    earliest = effect;
    found = items_[i];
  }
  return found;
}

}  // namespace splinecast::ipc
