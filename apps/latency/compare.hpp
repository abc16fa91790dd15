#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace splinecast::apps {

/// A percentile that has enough samples above it in both results.
struct ComparedPercentile {
  std::string name;  ///< of the series
  std::string from;
  double percent = 0;
  double a_ns = 0;
  double b_ns = 0;
  bool regressed = false;

  [[nodiscard]] double change() const { return 100 * (b_ns / a_ns - 1); }  ///< in percent
};

struct LatencyComparison {
  std::vector<ComparedPercentile> percentiles;
  std::vector<std::string> differences;  ///< of the machines, options and floors
  [[nodiscard]] std::size_t regressions() const;
};

/// Compares result B with A: B regressed at a percentile that is more than `threshold` percent and
/// more than `floor_ns` longer than A's. The floor and iceoryx belong to the machine, not to the
/// pipeline: they are not compared, but a floor that differs by more than the threshold is reported
/// as a difference. Throws InputError if either is not a result of `latency --json` in this format
/// version, or if no percentile has enough samples in both.
[[nodiscard]] LatencyComparison compare_latencies(const nlohmann::ordered_json& a,
                                                  const nlohmann::ordered_json& b, double threshold,
                                                  double floor_ns);

[[nodiscard]] nlohmann::ordered_json to_json(const LatencyComparison& comparison);

/// The comparison as a text table.
[[nodiscard]] std::string comparison_text(const LatencyComparison& comparison);

}  // namespace splinecast::apps
