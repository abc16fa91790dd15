#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// A histogram of latencies over time: windows of equal length, each with logarithmic bins,
/// kBinsPerOctave per factor of two.
class TimeGrid {
 public:
  static constexpr std::size_t kWindows = 200;
  static constexpr int kBinsPerOctave = 4;

  /// Covers [from, until); times outside count in the first or last window.
  TimeGrid(Time from, Time until);

  void record(Time at, Time latency);

  /// `window_s`, `bins_per_octave`, `greatest_ns` per window (null where nothing was recorded),
  /// and `cells`, a list of [window, bin, count] without the empty ones: a bin b holds latencies
  /// from 2^(b/bins_per_octave) ns on.
  [[nodiscard]] nlohmann::ordered_json json() const;

 private:
  struct Window {
    std::vector<std::uint64_t> counts;
    Time greatest{-1};
  };
  Time from_;
  Time window_;
  std::vector<Window> windows_;
};

}  // namespace splinecast::apps
