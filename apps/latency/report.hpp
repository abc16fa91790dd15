#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/latency/run.hpp"
#include "apps/timing/histogram.hpp"

namespace splinecast::apps {

/// One line of the table: the latencies of a stage, of the floor, or of a peer.
struct LatencySeries {
  std::string name;  ///< "append", "solved", "published", "seen", "floor", "iceoryx"
  std::string from;  ///< "intended" or "raw"
  const Histogram* histogram = nullptr;
  const Latencies* stage = nullptr;  ///< with the counts of missed deadlines; nullptr: none
};

/// All measured series: the pipeline and its peer from the intended instants on, the same raw, and
/// the floor, which is raw only. They point into `result`.
[[nodiscard]] std::vector<LatencySeries> series_of(const LatencyResult& result);

/// The format version of the JSON, which is the value of its first key.
inline constexpr int kLatencyForm = 1;

/// The result as JSON: `splinecast_latency` (the format version), `environment`, `options`,
/// `clock`, `warnings`, `interrupted`, `series`, `not_measured`, `processes`, `solver`. Times are
/// nanoseconds. A series has `name`, `from`, `count`, `least_ns`, `mean_ns`, `max_ns`,
/// `percentiles` (each with `percent`, `ns`, `above`, `enough`) and, from the intended instant,
/// `missed` and `missing`. Series without a count have no figures.
[[nodiscard]] nlohmann::ordered_json to_json(const LatencyResult& result);

/// The JSON of `to_json` as a text table. Percentiles with too few samples are in brackets; with
/// `dim` they are also dimmed by terminal escape sequences.
[[nodiscard]] std::string latency_text(const nlohmann::ordered_json& result, bool dim);

}  // namespace splinecast::apps
