#include "apps/latency/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/latency/report.hpp"
#include "apps/process/exit_codes.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

constexpr const char* kFloor = "floor";
constexpr const char* kPeer = "iceoryx";

void require_form(const ordered_json& result) {
  if (result.is_object() && result.contains("splinecast_latency") &&
      result["splinecast_latency"] == kLatencyForm) {
    return;
  }
  throw InputError(
      fmt::format("not a result of 'latency --json' in format version {}", kLatencyForm));
}

const ordered_json* find_series(const ordered_json& result, const ordered_json& name,
                                const ordered_json& from) {
  for (const auto& series : result.at("series")) {
    if (series.at("name") == name && series.at("from") == from) return &series;
  }
  return nullptr;
}

/// Visits each percentile that has enough samples in both results, with its two values.
template <typename Visit>
void for_each_common(const ordered_json& a, const ordered_json& b, const Visit& visit) {
  if (!a.contains("percentiles") || !b.contains("percentiles")) return;
  for (const auto& of_a : a["percentiles"]) {
    for (const auto& of_b : b["percentiles"]) {
      if (of_a.at("percent") != of_b.at("percent")) continue;
      if (of_a.at("enough").get<bool>() && of_b.at("enough").get<bool>()) visit(of_a, of_b);
    }
  }
}

std::string text_of(const ordered_json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

void note_differences(const char* what, const ordered_json& a, const ordered_json& b,
                      std::vector<std::string>& differences) {
  for (const auto& [key, value] : a.items()) {
    const ordered_json other = b.contains(key) ? b[key] : ordered_json();
    if (other == value) continue;
    differences.push_back(
        fmt::format("{} {}: {} in A, {} in B", what, key, text_of(value), text_of(other)));
  }
}

void note_floors(const ordered_json& a, const ordered_json& b, double threshold,
                 std::vector<std::string>& differences) {
  const ordered_json* const in_a = find_series(a, kFloor, "raw");
  const ordered_json* const in_b = find_series(b, kFloor, "raw");
  if (in_a == nullptr || in_b == nullptr) return;
  for_each_common(*in_a, *in_b, [&](const ordered_json& of_a, const ordered_json& of_b) {
    const auto ns_a = of_a.at("ns").get<double>();
    const auto ns_b = of_b.at("ns").get<double>();
    if (std::abs(ns_b - ns_a) * 100 <= threshold * std::min(ns_a, ns_b)) return;
    differences.push_back(fmt::format("floor at {} %: {} ns in A, {} ns in B",
                                      of_a.at("percent").get<double>(), ns_a, ns_b));
  });
}

}  // namespace

std::size_t LatencyComparison::regressions() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(percentiles, &ComparedPercentile::regressed));
}

LatencyComparison compare_latencies(const ordered_json& a, const ordered_json& b, double threshold,
                                    double floor_ns) {
  require_form(a);
  require_form(b);
  LatencyComparison found;
  note_differences("environment", a.at("environment"), b.at("environment"), found.differences);
  note_differences("option", a.at("options"), b.at("options"), found.differences);
  note_floors(a, b, threshold, found.differences);
  for (const auto& series : a.at("series")) {
    if (series.at("name") == kFloor || series.at("name") == kPeer) continue;
    const ordered_json* const other = find_series(b, series.at("name"), series.at("from"));
    if (other == nullptr) continue;
    for_each_common(series, *other, [&](const ordered_json& of_a, const ordered_json& of_b) {
      ComparedPercentile compared{.name = series.at("name"),
                                  .from = series.at("from"),
                                  .percent = of_a.at("percent"),
                                  .a_ns = of_a.at("ns"),
                                  .b_ns = of_b.at("ns")};
      compared.regressed = compared.b_ns > compared.a_ns * (1 + threshold / 100) &&
                           compared.b_ns > compared.a_ns + floor_ns;
      found.percentiles.push_back(std::move(compared));
    });
  }
  if (found.percentiles.empty()) {
    throw InputError("no percentile has enough samples in both: measure for longer");
  }
  return found;
}

ordered_json to_json(const LatencyComparison& comparison) {
  ordered_json percentiles = ordered_json::array();
  for (const ComparedPercentile& each : comparison.percentiles) {
    percentiles.push_back({{"name", each.name},
                           {"from", each.from},
                           {"percent", each.percent},
                           {"a_ns", each.a_ns},
                           {"b_ns", each.b_ns},
                           {"regressed", each.regressed}});
  }
  return {{"regressions", comparison.regressions()},
          {"differences", comparison.differences},
          {"percentiles", std::move(percentiles)}};
}

std::string comparison_text(const LatencyComparison& comparison) {
  std::string text;
  for (const std::string& difference : comparison.differences) {
    text += fmt::format("  differs: {}\n", difference);
  }
  text += fmt::format("  {:<18} {:<9} {:>8} {:>12} {:>12} {:>9}\n", "stage", "from", "", "A [µs]",
                      "B [µs]", "change");
  for (const ComparedPercentile& each : comparison.percentiles) {
    text += fmt::format("  {:<18} {:<9} {:>8} {:>12.2f} {:>12.2f} {:>+7.1f} %{}\n", each.name,
                        each.from, fmt::format("{} %", each.percent), each.a_ns / 1e3,
                        each.b_ns / 1e3, each.change(), each.regressed ? "  REGRESSION" : "");
  }
  return text + fmt::format("{} regressions among {} percentiles\n", comparison.regressions(),
                            comparison.percentiles.size());
}

}  // namespace splinecast::apps
