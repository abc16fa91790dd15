#include "support/refusal_watch.hpp"

#include <algorithm>

namespace splinecast::apps {
namespace {

constexpr int kHeadTries = 16;

}  // namespace

RefusalWatch::RefusalWatch(const std::string& stream, std::uint64_t stream_id,
                           const ipc::Trust& trust)
    : board_(stream, stream_id, trust) {
  if (copy_head()) seen_ = head_.refused;
}

bool RefusalWatch::copy_head() {
  for (int attempt = 0; attempt < kHeadTries; ++attempt) {
    const ipc::Word r = board_.reader().revision();
    if (r == head_.revision) return false;
    ipc::Head now;
    if (!board_.reader().copy_head(r, now)) continue;
    head_ = now;
    return true;
  }
  return false;
}

void RefusalWatch::look(const std::function<void(const ipc::RefusedItem&)>& refused) {
  if (!copy_head()) return;
  const ipc::Word kept = std::min<ipc::Word>(head_.refused, ipc::kRefusalsKept);
  const ipc::Word oldest = std::max(seen_, head_.refused - kept);
  missed_ += oldest - seen_;
  for (seen_ = oldest; seen_ < head_.refused; ++seen_) {
    const ipc::RefusedItem item = board_.reader().refusal(seen_);
    // Whatever overwrites it is a refusal of a later revision, and so of an item not yet consumed
    // under this head.
    if (item.item < head_.consumed) {
      refused(item);
    } else {
      ++missed_;
    }
  }
}

}  // namespace splinecast::apps
