#include "apps/trials/recovery.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace splinecast::apps {

void Recovery::end(Time now) {
  took_ms_.push_back(to_seconds(now - *since_) * 1e3);
  since_.reset();
}

void Recovery::add(const Recovery& other) {
  took_ms_.insert(took_ms_.end(), other.took_ms_.begin(), other.took_ms_.end());
}

nlohmann::json Recovery::result() const {
  std::vector<double> sorted = took_ms_;
  std::ranges::sort(sorted);
  const auto at = [&](double share) {
    return sorted.empty()
               ? 0.0
               : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  };
  return {{"kills", sorted.size()}, {"p50_ms", at(0.5)}, {"p99_ms", at(0.99)}, {"max_ms", at(1)}};
}

}  // namespace splinecast::apps
