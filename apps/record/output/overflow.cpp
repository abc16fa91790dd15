#include "apps/record/output/overflow.hpp"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include "apps/record/watch/events.hpp"

namespace splinecast::apps::record {

void Overflow::take(Batch& batch) {
  kept_.now = batch.now;
  std::map<std::uint32_t, Loss> lost;
  const auto note = [&](std::uint32_t stream) {
    const auto found = lost.find(stream);
    if (found == lost.end()) return;
    losses_[stream].add(found->second);
    lost.erase(found);
  };
  for (Record& record : batch.records) {
    if (record.kind == RecordKind::options || is_end_of_stream(record)) {
      note(record.stream);
      put_losses(record.stream);
      ++options_;
      kept_.add(std::move(record));
    } else if (record.kind == RecordKind::loss) {
      note(record.stream);
      losses_[record.stream].add(decode_loss(std::span(record.bytes).subspan(1)));
    } else {
      lost.try_emplace(record.stream, Loss{.cause = LossCause::queue}).first->second.count(record);
    }
  }
  while (!lost.empty()) note(lost.begin()->first);
  for (const EventNote& event : batch.events) {
    if (std::ranges::find(kept_.events, event) == kept_.events.end()) kept_.events.push_back(event);
  }
  batch = {.now = batch.now};
}

void Overflow::put_losses(std::uint32_t stream) {
  const auto found = losses_.find(stream);
  if (found == losses_.end()) return;
  for (const Loss& loss : found->second.losses()) add_loss(kept_, stream, loss, kept_.now);
  losses_.erase(found);
}

void Overflow::prepend_to(Batch& batch) {
  kept_.now = batch.now;
  while (!losses_.empty()) put_losses(losses_.begin()->first);
  std::ranges::move(batch.records, std::back_inserter(kept_.records));
  std::ranges::copy(batch.events, std::back_inserter(kept_.events));
  kept_.bytes += batch.bytes;
  options_ = 0;
  batch = std::exchange(kept_, {});
}

}  // namespace splinecast::apps::record
