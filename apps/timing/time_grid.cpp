#include "apps/timing/time_grid.hpp"

#include <algorithm>
#include <cmath>

namespace splinecast::apps {
namespace {

std::size_t bin_of(Time latency) {
  const auto ns = static_cast<double>(std::max<std::int64_t>(latency.count(), 1));
  return static_cast<std::size_t>(std::floor(TimeGrid::kBinsPerOctave * std::log2(ns)));
}

}  // namespace

TimeGrid::TimeGrid(Time from, Time until)
    : from_(from),
      window_((until - from) / static_cast<std::int64_t>(kWindows) + Time(1)),
      windows_(kWindows) {}

void TimeGrid::record(Time at, Time latency) {
  const auto last = static_cast<std::int64_t>(kWindows) - 1;
  Window& window =
      windows_[static_cast<std::size_t>(std::clamp<std::int64_t>((at - from_) / window_, 0, last))];
  const std::size_t bin = bin_of(latency);
  if (bin >= window.counts.size()) window.counts.resize(bin + 1);
  ++window.counts[bin];
  window.greatest = std::max(window.greatest, latency);
}

nlohmann::ordered_json TimeGrid::json() const {
  using nlohmann::ordered_json;
  ordered_json greatest = ordered_json::array();
  ordered_json cells = ordered_json::array();
  for (std::size_t w = 0; w < windows_.size(); ++w) {
    const Window& window = windows_[w];
    greatest.push_back(window.counts.empty() ? ordered_json()
                                             : ordered_json(window.greatest.count()));
    for (std::size_t bin = 0; bin < window.counts.size(); ++bin) {
      if (window.counts[bin] > 0) cells.push_back({w, bin, window.counts[bin]});
    }
  }
  return {{"window_s", to_seconds(window_)},
          {"bins_per_octave", kBinsPerOctave},
          {"greatest_ns", std::move(greatest)},
          {"cells", std::move(cells)}};
}

}  // namespace splinecast::apps
