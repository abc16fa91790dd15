#include <algorithm>

#include "apps/contents/contents.hpp"

namespace splinecast::apps {

void TimeSpans::add(Time time, bool may_repeat) {
  ++count_;
  const bool is_in_order = !last_ || time > *last_ || (may_repeat && time == *last_);
  if (!is_in_order) ++not_increasing_;
  if (last_ && time > *last_) {
    const Pause pause{.begin = *last_, .length = time - *last_};
    const bool is_long = pauses_.size() < kPauses || pause.length > pauses_.back().length;
    if (is_long) {
      if (pauses_.size() == kPauses) pauses_.pop_back();
      const auto place = std::ranges::find_if(
          pauses_, [&](const Pause& each) { return each.length < pause.length; });
      pauses_.insert(place, pause);
    }
  }
  first_ = std::min(first_.value_or(time), time);
  last_ = std::max(last_.value_or(time), time);
}

double TimeSpans::rate() const noexcept {
  if (count_ < 2 || *last_ == *first_) return 0;
  return static_cast<double>(count_ - 1) / to_seconds(*last_ - *first_);
}

}  // namespace splinecast::apps
