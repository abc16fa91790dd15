#include "tests/campaign/record/ranges.hpp"

#include <algorithm>
#include <utility>

namespace splinecast::campaign::record {

void Ranges::add(const Span& range) {
  if (range.count == 0) return;
  if (!ranges_.empty() && ranges_.back().end() == range.first) {
    ranges_.back().count += range.count;
  } else {
    ranges_.push_back(range);
  }
}

void Ranges::add(const Ranges& other) {
  for (const Span& range : other.ranges_) add(range);
}

std::uint64_t Ranges::tidy() {
  const std::uint64_t all = count();
  std::vector<Span> old = std::exchange(ranges_, {});
  std::ranges::sort(old, {}, &Span::first);
  for (const Span& range : old) add(range.from(end()));
  return all - count();
}

std::uint64_t Ranges::count() const noexcept {
  std::uint64_t sum = 0;
  for (const Span& range : ranges_) sum += range.count;
  return sum;
}

std::uint64_t Ranges::end() const noexcept { return ranges_.empty() ? 0 : ranges_.back().end(); }

std::uint64_t Ranges::missing(std::uint64_t end) const noexcept {
  std::uint64_t there = 0;
  for (const Span& range : ranges_) {
    if (range.first < end) there += std::min(range.end(), end) - range.first;
  }
  return end - there;
}

std::uint64_t Ranges::common(const Ranges& other) const {
  Ranges both = *this;
  both.add(other);
  return both.tidy();
}

std::uint64_t Ranges::first_missing() const noexcept {
  return ranges_.empty() || ranges_.front().first > 0 ? 0 : ranges_.front().end();
}

}  // namespace splinecast::campaign::record
