#include "apps/record/output/dump_schedule.hpp"

#include <algorithm>
#include <utility>

namespace splinecast::apps::record {

bool DumpSchedule::take_event(std::string_view why, Time now) {
  const Time until = saturated_sum(now, after_);
  if (!is_open_) {
    const bool is_soon = ended_ && now - *ended_ < last_;
    begin(now, is_soon ? std::max(until, saturated_sum(now, last_)) : until);
    return true;
  }
  ++further_events_;
  if (now - began_ < std::max(last_, after_)) {
    end_ = std::max(end_, until);
  } else if (!next_) {
    next_ = Next{.why = std::string(why), .until = until};
  } else {
    next_->until = until;
  }
  return false;
}

void DumpSchedule::take_trigger(Time now) noexcept {
  Time end = saturated_sum(now, after_);
  if (is_open_) end = std::max(end, end_);
  if (next_) end = std::max(end, next_->until);
  next_.reset();
  begin(now, end);
}

std::optional<std::string> DumpSchedule::close(Time now) {
  is_open_ = false;
  ended_ = now;
  const std::optional<Next> next = std::exchange(next_, std::nullopt);
  if (!next) return std::nullopt;
  begin(now, std::max(next->until, saturated_sum(now, last_)));
  return next->why;
}

void DumpSchedule::begin(Time now, Time end) noexcept {
  is_open_ = true;
  began_ = now;
  end_ = end;
}

}  // namespace splinecast::apps::record
