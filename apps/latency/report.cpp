#include "apps/latency/report.hpp"

#include <fmt/format.h>

#include "apps/timing/percentiles.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

ordered_json cpu_json(const std::optional<int>& cpu) {
  return cpu ? ordered_json(*cpu) : ordered_json();
}

ordered_json options_json(const LatencyOptions& options) {
  return {{"rate", options.rate},
          {"duration_s", to_seconds(options.duration)},
          {"warmup_s", to_seconds(options.warmup)},
          {"lead_ms", to_seconds(options.lead) * 1e3},
          {"deadline_ns", options.measured({}).deadline.count()},
          {"dims", options.dimensions},
          {"settle", options.settle ? ordered_json(*options.settle) : ordered_json()},
          {"readers", options.readers},
          {"embedded", options.embedded},
          {"mode", options.spin ? "spin" : "wait"},
          {"cpu_producer", cpu_json(options.cpu_producer)},
          {"cpu_solver", cpu_json(options.cpu_solver)},
          {"cpu_reader", options.cpu_readers},
          {"policy", options.fifo ? "fifo" : "other"},
          {"priority", options.fifo ? ordered_json(options.priority) : ordered_json()},
          {"mlock", options.lock_memory}};
}

ordered_json series_json(const LatencySeries& series) {
  const Histogram& histogram = *series.histogram;
  ordered_json json{{"name", series.name}, {"from", series.from}, {"count", histogram.count()}};
  if (histogram.count() > 0) {
    json["least_ns"] = histogram.least().count();
    json["mean_ns"] = histogram.mean();
    json["max_ns"] = histogram.greatest().count();
    json["percentiles"] = ordered_json::array();
    for (const std::uint64_t thousandths : kPercentiles) {
      const Percentile percentile = percentile_of(histogram, thousandths);
      json["percentiles"].push_back({{"percent", percentile.percent},
                                     {"ns", percentile.value.count()},
                                     {"above", percentile.above},
                                     {"enough", percentile.has_enough()}});
    }
  }
  if (series.stage != nullptr) {
    json["missed"] = series.stage->missed;
    json["missing"] = series.stage->missing;
  }
  return json;
}

constexpr int kNameWidth = 20;
constexpr int kWidth = 11;

std::string microseconds(const ordered_json& ns) {
  return fmt::format("{:.2f}", ns.get<double>() / 1e3);
}

std::string percentile_cell(const ordered_json& percentile, bool dim) {
  const std::string value = microseconds(percentile["ns"]);
  if (percentile["enough"].get<bool>()) return fmt::format(" {:>{}}", value, kWidth);
  const std::string bracketed = fmt::format(" {:>{}}", "(" + value + ")", kWidth);
  return dim ? "\033[2m" + bracketed + "\033[0m" : bracketed;
}

std::string series_row(const ordered_json& series, bool dim) {
  std::string row = fmt::format("  {:<{}} {:>9}", series["name"].get<std::string>(), kNameWidth,
                                series["count"].get<std::uint64_t>());
  if (series.contains("percentiles")) {
    for (const auto& percentile : series["percentiles"]) row += percentile_cell(percentile, dim);
    row += fmt::format(" {:>{}}", microseconds(series["max_ns"]), kWidth);
  }
  if (series.contains("missed")) row += fmt::format(" {:>8}", series["missed"].get<std::size_t>());
  return row + "\n";
}

std::string table_head(const std::string& title, bool with_missed) {
  std::string summary = fmt::format("\n{}\n  {:<{}} {:>9}", title, "", kNameWidth, "count");
  for (const std::uint64_t thousandths : kPercentiles) {
    summary += fmt::format(" {:>{}}", fmt::format("{} %", static_cast<double>(thousandths) / 1000),
                           kWidth);
  }
  return summary + fmt::format(" {:>{}}", "max", kWidth) + (with_missed ? "   missed\n" : "\n");
}

std::string table(const ordered_json& result, const char* from, const std::string& title,
                  bool dim) {
  std::string rows;
  bool with_missed = false;
  for (const auto& series : result["series"]) {
    if (series["from"] != from) continue;
    with_missed = with_missed || series.contains("missed");
    rows += series_row(series, dim);
  }
  return table_head(title, with_missed) + rows;
}

std::string title_of(const ordered_json& options) {
  const auto readers = options["readers"].get<std::size_t>();
  return fmt::format(
      "{} waypoints/s of {} dimensions for {} s after {} s of warm-up, open loop\n{} and {} "
      "reader{}, each a process, in mode {}; deadline {:.3f} ms\n",
      options["rate"].get<double>(), options["dims"].get<std::size_t>(),
      options["duration_s"].get<double>(), options["warmup_s"].get<double>(),
      options["embedded"].get<bool>() ? "producer with the solver in it" : "producer, solver",
      readers, readers == 1 ? "" : "s", options["mode"].get<std::string>(),
      options["deadline_ns"].get<double>() / 1e6);
}

std::string warnings_text(const ordered_json& warnings) {
  std::string text;
  for (const auto& warning : warnings) {
    text += fmt::format("\n  *** WARNING: {} ***", warning.get<std::string>());
  }
  return text.empty() ? text : text + "\n";
}

std::string processes_text(const ordered_json& processes) {
  std::string text =
      fmt::format("\n  {:<{}} {:>13} {:>13} {:>19} {:>21}\n", "", kNameWidth, "minor faults",
                  "major faults", "voluntary switches", "involuntary switches");
  for (const auto& process : processes) {
    text += fmt::format(
        "  {:<{}} {:>13} {:>13} {:>19} {:>21}\n", process["role"].get<std::string>(), kNameWidth,
        process["minor_faults"].get<std::int64_t>(), process["major_faults"].get<std::int64_t>(),
        process["voluntary_switches"].get<std::int64_t>(),
        process["involuntary_switches"].get<std::int64_t>());
  }
  return text;
}

std::string machine_text(const ordered_json& result) {
  const auto& clock = result["clock"];
  const auto& solver = result["solver"];
  std::string text = fmt::format(
      "\nsolver: {} revisions, {} deadline misses, {} late commits\n"
      "clock: {:.1f} ns per reading, steps of {} ns\n",
      solver["revisions"].get<std::uint64_t>(), solver["deadline_misses"].get<std::uint64_t>(),
      solver["late_commits"].get<std::uint64_t>(), clock["cost_ns"].get<double>(),
      clock["resolution_ns"].get<double>());
  std::string facts;
  for (const auto& [name, value] : result["environment"].items()) {
    const auto fact = value.get<std::string>();
    facts += fmt::format("{}{} {}", facts.empty() ? "" : "; ", name, fact.empty() ? "-" : fact);
  }
  return text + facts + "\n";
}

}  // namespace

std::vector<LatencySeries> series_of(const LatencyResult& result) {
  std::vector<const Latencies*> stages;
  stages.reserve(result.stages.size() + 1);
  for (const Latencies& stage : result.stages) stages.push_back(&stage);
  if (result.iceoryx.seen) stages.push_back(&*result.iceoryx.seen);
  std::vector<LatencySeries> all;
  all.reserve(2 * stages.size());
  for (const Latencies* const stage : stages) {
    all.push_back(
        {.name = stage->stage, .from = "intended", .histogram = &stage->intended, .stage = stage});
  }
  for (const Latencies* const stage : stages) {
    all.push_back(
        {.name = stage->stage, .from = "raw", .histogram = &stage->raw, .stage = nullptr});
  }
  if (result.floor.one_way.count() > 0) {
    all.push_back(
        {.name = "floor", .from = "raw", .histogram = &result.floor.one_way, .stage = nullptr});
  }
  return all;
}

ordered_json to_json(const LatencyResult& result) {
  ordered_json series = ordered_json::array();
  for (const LatencySeries& each : series_of(result)) series.push_back(series_json(each));
  ordered_json not_measured = ordered_json::object();
  if (result.floor.one_way.count() == 0) not_measured["floor"] = result.floor.reason;
  if (!result.iceoryx.seen) not_measured["iceoryx"] = result.iceoryx.reason;
  return {{"splinecast_latency", kLatencyForm},
          {"environment", to_json(result.environment)},
          {"options", options_json(result.options)},
          {"clock", to_json(result.clock)},
          {"warnings", result.warnings},
          {"interrupted", result.interrupted},
          {"series", std::move(series)},
          {"not_measured", std::move(not_measured)},
          {"processes", result.processes},
          {"solver", result.solver}};
}

std::string latency_text(const ordered_json& result, bool dim) {
  std::string text = title_of(result["options"]) + warnings_text(result["warnings"]);
  text += table(result, "intended", "latency from the intended instant on, µs", dim);
  text += table(result, "raw", "raw, from the start of the append on, µs", dim);
  text += "  (In brackets: fewer than ten samples are above; another run would differ.)\n";
  for (const auto& [name, reason] : result["not_measured"].items()) {
    text += fmt::format("  {} not measured: {}\n", name, reason.get<std::string>());
  }
  return text + processes_text(result["processes"]) + machine_text(result);
}

}  // namespace splinecast::apps
