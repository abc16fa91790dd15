#include "support/refusal_watch.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "support/exit_codes.hpp"

namespace splinecast::apps {
namespace {

constexpr int kHeadTries = 16;

ipc::SegmentBoardReader board_of(const ipc::Region& region, const std::string& stream,
                                 std::uint64_t stream_id) {
  const ipc::RegionHeader header = ipc::copy_header(region.bytes());
  if (header.stream_id != stream_id) {
    throw Failure(fmt::format("stream '{}' has been made anew by another producer", stream));
  }
  return {region.bytes(), ipc::checked_board_layout(header, region.bytes().size())};
}

}  // namespace

RefusalWatch::RefusalWatch(const std::string& stream, std::uint64_t stream_id,
                           const ipc::Trust& trust)
    : region_(ipc::Region::open(stream, ipc::RegionKind::spline, false, trust)),
      board_(board_of(region_, stream, stream_id)) {
  if (copy_head()) seen_ = head_.refused;
}

bool RefusalWatch::copy_head() {
  for (int attempt = 0; attempt < kHeadTries; ++attempt) {
    const ipc::Word r = board_.revision();
    if (r == head_.revision) return false;
    ipc::Head now;
    if (!board_.copy_head(r, now)) continue;
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
    const ipc::RefusedItem item = board_.refusal(seen_);
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
