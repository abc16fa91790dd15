#include "apps/record/watch/ring_watch.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

#include "apps/record/watch/events.hpp"
#include "ipc/layout/table.hpp"
#include "ipc/options/stream.hpp"

namespace splinecast::apps::record {
namespace {

/// A ring is filled fast if a look finds more than this part of it.
constexpr ipc::Word kFast = 16;

/// The oldest item that a ring may still have.
ipc::Word oldest_of(const ipc::WaypointRingReader& ring) noexcept {
  const ipc::Word written = ring.written();
  return written - std::min<ipc::Word>(written, ring.capacity());
}

}  // namespace

std::pair<ipc::Word, ipc::Word> owner_of(std::span<const std::byte> region) noexcept {
  const auto words = ipc::words_at(region, 0, ipc::kHeaderWords);
  // In this order: see enter_owner().
  const ipc::Word epoch = ipc::load(words[ipc::kEpoch], std::memory_order_acquire);
  return {epoch, ipc::load(words[ipc::kOwnerPid], std::memory_order_relaxed)};
}

RingWatch::RingWatch(std::uint32_t number, ipc::CheckedRegion<ipc::RingLayout> ring,
                     const StreamTimes& times)
    : number_(number),
      ring_(std::move(ring)),
      reader_(ring_.region.bytes(), ring_.layout),
      times_(times),
      item_(ring_.layout.dimensions),
      old_until_(reader_.written()) {
  ring_.region.close_descriptor();
}

bool RingWatch::look(Batch& batch) {
  bool has_lost = false;
  const ipc::Word written = reader_.written();
  is_filled_fast_ = (written - next_) * kFast > reader_.capacity();
  while (next_ < written) {
    if (reader_.observe(next_, item_)) {
      put_item(batch);
      ++next_;
      continue;
    }
    const ipc::Word oldest = std::clamp(oldest_of(reader_), next_ + 1, written);
    add_loss(batch, number_,
             {.cause = has_any_ ? LossCause::overwritten : LossCause::before,
              .items = {.first = next_, .count = oldest - next_}},
             times_.stream_time(batch.now, item_.time));
    next_ = oldest;
    set_incomplete_before(next_);
    has_lost = true;
  }
  return has_lost;
}

/// Writes item_, which has number next_.
void RingWatch::put_item(Batch& batch) {
  has_any_ = true;
  if (item_.kind == ipc::ItemKind::waypoint) open_.push_back({.number = next_, .time = item_.time});
  // The pieces of a plan are needed together, as long as its run lasts.
  const bool is_plan = item_.kind == ipc::ItemKind::rate && item_.place == 0;
  if (is_plan) open_.push_back({.number = next_, .time = Time::max()});
  batch.add({.stream = number_,
             .kind = RecordKind::item,
             .number = next_,
             .next = next_ + 1,
             .own_time = times_.wall_time(item_.time, batch.now),
             .is_old = next_ < old_until_,
             .bytes = encode({.number = next_, .is_old = next_ < old_until_, .item = item_})});
}

void RingWatch::set_incomplete_before(ipc::Word item) noexcept {
  complete_from_ = std::max(complete_from_, item);
}

void RingWatch::forget_before(ipc::Word item) noexcept {
  while (!open_.empty() && open_.front().number < item) open_.pop_front();
}

std::optional<ipc::Word> RingWatch::first_after(ipc::Word run_item, Time time) {
  forget_before(run_item);
  while (!open_.empty() && open_.front().time <= time) open_.pop_front();
  const ipc::Word first = open_.empty() ? next_ : open_.front().number;
  const bool is_known = complete_from_ <= run_item || first > complete_from_;
  return is_known ? std::optional(first) : std::nullopt;
}

void RingWatch::note_refused(ipc::Word item) noexcept {
  const auto found = std::ranges::lower_bound(open_, item, {}, &OpenItem::number);
  if (found != open_.end() && found->number == item) found->is_refused = true;
}

std::optional<ipc::Word> RingWatch::waypoint_at(ipc::Word run_item, Time time) const noexcept {
  const auto first = std::ranges::lower_bound(open_, run_item, {}, &OpenItem::number);
  const auto found = std::find_if(first, open_.end(), [time](const OpenItem& item) {
    return item.time == time && !item.is_refused;
  });
  return found != open_.end() ? std::optional(found->number) : std::nullopt;
}

std::pair<ipc::Word, ipc::Word> RingWatch::owner() const noexcept {
  return owner_of(ring_.region.bytes());
}

}  // namespace splinecast::apps::record
