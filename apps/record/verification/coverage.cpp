#include "apps/record/verification/coverage.hpp"

#include <algorithm>

namespace splinecast::apps::record {

void Coverage::add(const NumberSpan& range) {
  if (range.count == 0) return;
  end_ = std::max(end_, range.end());
  if (!ranges_.empty() && ranges_.back().end() == range.first) {
    ranges_.back().count += range.count;
  } else {
    ranges_.push_back(range);
  }
}

ipc::Word Coverage::missing(ipc::Word first, ipc::Word end) const {
  std::vector<NumberSpan> sorted = ranges_;
  std::ranges::sort(sorted, {}, &NumberSpan::first);
  ipc::Word missing = 0;
  ipc::Word at = first;
  for (const NumberSpan& range : sorted) {
    if (range.first >= end) break;
    if (range.first > at) missing += range.first - at;
    at = std::max(at, range.end());
  }
  return missing + (end > at ? end - at : 0);
}

}  // namespace splinecast::apps::record
