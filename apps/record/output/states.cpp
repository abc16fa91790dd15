#include "apps/record/output/states.hpp"

#include <algorithm>
#include <cmath>

#include "core/polynomial/segment.hpp"
#include "ipc/options/stream.hpp"

namespace splinecast::apps::record {

States::States(const ipc::RegionHeader& header, double hz)
    : kinds_(ipc::dimension_kinds(header)),
      interval_(std::max<std::int64_t>(1, std::llround(1e9 / hz))),
      state_(header.dimensions) {}

void States::sample(const ipc::SegmentCopy& segment, const Take& take) {
  const std::int64_t step = interval_.count();
  const std::int64_t left = segment.left.count();
  // The first multiple of the interval from the left end on.
  const std::int64_t before = left >= 0 ? (left + step - 1) / step : -(-left / step);
  Time time(before * step);
  for (std::int64_t n = 0; n < kMost && time < segment.right; ++n, time += interval_) {
    core::evaluate(segment.order, segment.coefficients, to_seconds(time - segment.left),
                   state_.ref());
    const StateRef state = state_.ref();
    kinds_.normalise(state);
    take(time, state_);
  }
}

}  // namespace splinecast::apps::record
