#include "apps/latency/page.hpp"

#include "apps/latency/report.hpp"
#include "apps/pages/html_page.hpp"
#include "apps/pages/templates.hpp"
#include "apps/timing/hgrm.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

/// A curve: [1/(1 − share), ns] of each step but the last, which is at infinity.
ordered_json curve_json(const Histogram& histogram) {
  ordered_json curve = ordered_json::array();
  for_each_percentile(histogram, [&](const PercentileStep& step) {
    if (step.level < 100) curve.push_back({1 / (1 - step.level / 100), step.value.count()});
  });
  return curve;
}

}  // namespace

void write_latency_page(const LatencyResult& result, Output& output) {
  ordered_json data = to_json(result);
  const auto all = series_of(result);
  for (std::size_t i = 0; i < all.size(); ++i) {
    data["series"][i]["curve"] = curve_json(*all[i].histogram);
    if (all[i].stage != nullptr) data["series"][i]["over_time"] = all[i].stage->over_time.json();
  }
  write_page(latency_template(), data, output);
}

}  // namespace splinecast::apps
