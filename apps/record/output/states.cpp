#include "apps/record/output/states.hpp"

#include <algorithm>
#include <cmath>

#include "ipc/options/stream.hpp"

namespace splinecast::apps::record {

States::States(const ipc::RegionHeader& header, const SamplingRate& rate)
    : kinds_(ipc::dimension_kinds(header)),
      interval_(std::max<std::int64_t>(1, std::llround(1e9 / rate.hz))),
      most_(rate.most),
      state_(header.dimensions) {}

Time States::step_of(Time left, Time right) const noexcept {
  const std::int64_t intervals = (right - left) / interval_;
  return interval_ * (1 + intervals / most_);
}

Time States::first_from(Time time, Time step) noexcept {
  const std::int64_t remainder = time % step / Time(1);
  const bool is_after_multiple = remainder > 0;
  return time - Time(remainder) + (is_after_multiple ? step : Time::zero());
}

}  // namespace splinecast::apps::record
