#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/latency/run.hpp"
#include "apps/process/settings.hpp"
#include "tests/fixtures/processes/browser.hpp"
#include "tests/fixtures/processes/process.hpp"

/// `latency` with real processes. No test depends on how long anything takes.
namespace splinecast::apps {
namespace {

using nlohmann::json;
using testing::Ended;
using testing::TestFolder;

/// Runs `latency` for 1 s without iceoryx. The long lead prevents late waypoints also on a busy
/// machine.
Ended measure(std::vector<std::string> arguments) {
  const std::vector<std::string> common{"latency", "--duration",  "1",   "--warmup",
                                        "0.2",     "--rate",      "200", "--lead",
                                        "10000",   "--no-iceoryx"};
  arguments.insert(arguments.begin(), common.begin(), common.end());
  return testing::run(arguments);
}

json measure_json(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const Ended ended = measure(arguments);
  EXPECT_EQ(ended.code, 0) << ended.err;
  return ended.code == 0 ? json::parse(ended.out) : json();
}

const json* find_series(const json& result, const std::string& name, const std::string& from) {
  for (const json& series : result.at("series")) {
    if (series.at("name") == name && series.at("from") == from) return &series;
  }
  return nullptr;
}

/// Expects that every stage counts all 200 waypoints and that none is appended before it is due: a
/// percentile from the intended instant is never shorter than the raw one.
void expect_pipeline(const json& result, const std::vector<std::string>& stages) {
  for (const std::string& name : stages) {
    const json* const intended = find_series(result, name, "intended");
    const json* const raw = find_series(result, name, "raw");
    ASSERT_TRUE(intended != nullptr && raw != nullptr) << name;
    EXPECT_EQ(intended->at("count"), 200) << name;
    EXPECT_EQ(raw->at("count"), 200) << name;
    EXPECT_GE(raw->at("least_ns"), 0) << name;
    for (std::size_t i = 0; i < raw->at("percentiles").size(); ++i) {
      EXPECT_GE(intended->at("percentiles")[i].at("ns"), raw->at("percentiles")[i].at("ns"));
    }
  }
}

void expect_percentiles(const json& series) {
  ASSERT_EQ(series.at("percentiles").size(), 6U);
  std::int64_t last = series.at("least_ns");
  const std::array<double, 6> percents{50, 90, 99, 99.9, 99.99, 99.999};
  for (std::size_t i = 0; i < percents.size(); ++i) {
    const json& each = series["percentiles"][i];
    EXPECT_EQ(each.at("percent"), percents[i]);
    EXPECT_GE(each.at("ns").get<std::int64_t>(), last);
    last = each.at("ns");
    EXPECT_EQ(each.at("enough").get<bool>(), each.at("above").get<int>() >= 10);
  }
  EXPECT_GE(series.at("max_ns").get<std::int64_t>(), last);
}

TEST(Latency, MeasuresEveryWaypointAtEveryStageInSeparateProcesses) {
  const json result = measure_json({});
  ASSERT_TRUE(result.is_object());
  EXPECT_EQ(result.at("splinecast_latency"), 1);
  expect_pipeline(result, {"append", "solved", "published", "seen"});
  for (const json& series : result.at("series")) {
    if (series.at("count") > 0) expect_percentiles(series);
    EXPECT_EQ(series.contains("missed"), series.at("from") == "intended");
  }
  EXPECT_EQ(find_series(result, "seen", "intended")->at("missing"), 0);
  EXPECT_EQ(result.at("not_measured").at("iceoryx"), "disabled by --no-iceoryx");
  EXPECT_EQ(result.at("interrupted"), false);
  EXPECT_EQ(result.at("options").at("mode"), "wait");
  EXPECT_EQ(result["options"].at("deadline_ns"), 5'000'000);
  EXPECT_GT(result.at("clock").at("cost_ns").get<double>(), 0);
  EXPECT_GT(result["clock"].at("resolution_ns").get<double>(), 0);
  EXPECT_FALSE(result.at("environment").at("kernel").get<std::string>().empty());
  EXPECT_EQ(result.at("solver").at("refused"), 0);
  // Includes the 40 waypoints of the warm-up.
  const int interpolated = result["solver"].at("interpolated");
  const int passed_over = result["solver"].at("passed_over");
  EXPECT_EQ(interpolated + passed_over, 240);
  ASSERT_EQ(result.at("processes").size(), 3U);
  for (const json& process : result["processes"]) {
    EXPECT_GE(process.at("minor_faults").get<int>(), 0);
    EXPECT_GE(process.at("major_faults").get<int>(), 0);
    EXPECT_GE(process.at("voluntary_switches").get<int>(), 0);
    EXPECT_GE(process.at("involuntary_switches").get<int>(), 0);
  }
}

TEST(Latency, MeasuresEachOfSeveralReadersAndASolverInTheProducersProcess) {
  const json result =
      measure_json({"--embedded", "--readers", "2", "--dims", "3", "--settle", "4"});
  ASSERT_TRUE(result.is_object());
  expect_pipeline(result,
                  {"append", "solved", "published", "seen by reader 0", "seen by reader 1"});
  ASSERT_EQ(result.at("processes").size(), 3U);
  EXPECT_EQ(result["processes"][0].at("role"), "producer and solver");
  EXPECT_EQ(result.at("options").at("dims"), 3);
  EXPECT_EQ(result["options"].at("settle"), 4);
}

TEST(Latency, WarnsIfItSpinsOnTooFewCpus) {
  const std::string cpus = std::to_string(usable_cpus());
  const json result = measure_json({"--mode", "spin", "--readers", cpus});
  ASSERT_TRUE(result.is_object());
  EXPECT_EQ(result.at("options").at("mode"), "spin");
  ASSERT_FALSE(result.at("warnings").empty());
  EXPECT_NE(result["warnings"].dump().find("spin on " + cpus + " CPUs"), std::string::npos);
}

TEST(Latency, WarnsIfPinningFails) {
  const std::vector<std::string> impossible{"--cpu-producer", "999", "--cpu-reader", "998"};
  const Ended text = measure(impossible);
  ASSERT_EQ(text.code, 0) << text.err;
  for (const char* const warning :
       {"the producer is not pinned to CPU 999", "the reader is not pinned to CPU 998"}) {
    EXPECT_NE(text.err.find(std::string("WARNING: ") + warning), std::string::npos) << text.err;
    EXPECT_NE(text.out.find(std::string("*** WARNING: ") + warning), std::string::npos);
  }
  EXPECT_EQ(text.err.find("solver is not pinned"), std::string::npos);
}

TEST(Latency, PutsPercentilesWithTooFewSamplesInBrackets) {
  const Ended text = measure({});
  ASSERT_EQ(text.code, 0) << text.err;
  // 200 samples: 20 above the 90th percentile, 2 above the 99th.
  const std::string row = testing::between(text.out, "  seen ", "\n");
  EXPECT_EQ(std::ranges::count(row, '('), 4) << row;
  EXPECT_NE(text.out.find("fewer than ten samples"), std::string::npos);
  EXPECT_NE(text.out.find("iceoryx not measured: disabled by --no-iceoryx"), std::string::npos);
}

TEST(Latency, WritesPercentileTextOfEachStage) {
  const TestFolder folder;
  ASSERT_EQ(measure({"--hgrm", folder.path("run")}).code, 0);
  for (const char* const stage : {"append", "solved", "published", "seen", "seen.raw"}) {
    const std::string text = testing::read_file(folder.path("run." + std::string(stage) + ".hgrm"));
    EXPECT_TRUE(text.starts_with("       Value     Percentile TotalCount 1/(1-Percentile)\n\n"));
    EXPECT_NE(text.find("Total count    =          200]"), std::string::npos) << text;
  }
}

TEST(Latency, WarnsOfTheKernelsThrottlingWhereFifoProcessesSpin) {
  Environment environment;
  environment.rt_runtime = "950000";
  environment.rt_period = "1000000";
  LatencyOptions options;
  options.fifo = true;
  EXPECT_EQ(throttling_warning(options, environment), "");  // they sleep
  options.spin = true;
  EXPECT_NE(throttling_warning(options, environment).find("for 50 ms of each 1000000 us"),
            std::string::npos);
  environment.rt_runtime = "";
  EXPECT_NE(throttling_warning(options, environment).find("unknown whether"), std::string::npos);
  environment.rt_runtime = "-1";
  EXPECT_EQ(throttling_warning(options, environment), "");
  options.fifo = false;
  environment.rt_runtime = "950000";
  EXPECT_EQ(throttling_warning(options, environment), "");
}

TEST(Latency, RefusesInvalidOptions) {
  const std::vector<std::vector<std::string>> wrong{
      {"--rate", "0"},
      {"--rate", "1e6"},
      {"--duration", "0"},
      {"--duration", "1e6"},
      {"--mode", "sometimes"},
      {"--policy", "rr"},
      {"--prio", "100"},
      {"--dims", "65"},
      {"--readers", "0"},
      {"--cpu-producer", "1024"},
      {"--cpu-reader", "0,x"},
      {"--deadline", "0"},
      {"--mode", "spin", "--policy", "fifo", "--cpu-producer", "0", "--cpu-solver", "0"}};
  for (const auto& arguments : wrong) {
    std::vector<std::string> all{"latency", "--no-iceoryx"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Ended ended = testing::run(all);
    EXPECT_EQ(ended.code, 2) << arguments[0] << " " << arguments[1] << ": " << ended.err;
  }
}

TEST(Latency, LeavesNothingInSharedMemory) {
  testing::Process measuring({"latency", "--duration", "1", "--warmup", "0", "--no-iceoryx"});
  const std::string name = "latency." + std::to_string(measuring.pid());
  EXPECT_EQ(measuring.wait().code, 0);
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
    EXPECT_EQ(entry.path().string().find(name + "."), std::string::npos) << entry.path();
  }
}

/// A measurement at 1 kHz that SIGTERM ends when the solver has interpolated some waypoints.
Ended interrupted_latency() {
  testing::Process measuring({"latency", "--duration", "3600", "--rate", "1000", "--warmup", "0",
                              "--no-iceoryx", "--json"});
  const std::string name = "latency." + std::to_string(measuring.pid());
  EXPECT_TRUE(testing::await([&] {
    const json now = testing::info(name);
    return now.is_object() && now.contains("solver") && now["solver"].is_object() &&
           now["solver"]["interpolated"].get<int>() > 10;
  }));
  measuring.signal(SIGTERM);
  return measuring.wait();
}

TEST(Latency, AStopSignalEndsItEarlyWithPartialResults) {
  Ended ended = interrupted_latency();
  // On a busy machine the signal may come before a reader has seen one of them.
  for (int i = 0; i < 20 && ended.out.empty(); ++i) ended = interrupted_latency();
  EXPECT_EQ(ended.code, 130) << ended.err;
  const json result = json::parse(ended.out);
  EXPECT_EQ(result.at("interrupted"), true);
  EXPECT_GT(find_series(result, "append", "intended")->at("count").get<int>(), 10);
}

TEST(Latency, AStopSignalInItsLastPartAlsoInterruptsIt) {
  const Ended ended = testing::interrupt_in_time(
      [] {
        testing::Process measuring({"latency", "--duration", "3", "--warmup", "0", "--json"});
        const std::string name = "latency." + std::to_string(measuring.pid());
        EXPECT_TRUE(testing::await([&] { return testing::info(name).is_object(); }));
        EXPECT_TRUE(testing::await([&] { return !testing::info(name).is_object(); }));
        return measuring;
      },
      [](const testing::Process& measuring) { return measuring.pid(); });
  const json result = json::parse(ended.out, nullptr, false);
  ASSERT_TRUE(result.is_object()) << ended.out << ended.err;
  if (ended.code == 0 && result.at("not_measured").contains("iceoryx")) {
    GTEST_SKIP() << "iceoryx: " << result["not_measured"]["iceoryx"];
  }
  EXPECT_EQ(ended.code, 130) << ended.err;
  EXPECT_EQ(result.at("interrupted"), true);
  EXPECT_EQ(result.at("not_measured").at("iceoryx"), "interrupted");
}

TEST(Latency, MeasuresIceoryxOrReportsWhyNot) {
  const Ended ended =
      testing::run({"latency", "--duration", "1", "--warmup", "0.2", "--rate", "200", "--json"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json result = json::parse(ended.out);  // contains no output of iceoryx itself
  const json* const iceoryx = find_series(result, "iceoryx", "intended");
  if (iceoryx == nullptr) {
    EXPECT_FALSE(result.at("not_measured").at("iceoryx").get<std::string>().empty());
    GTEST_SKIP() << "iceoryx: " << result["not_measured"]["iceoryx"];
  }
  EXPECT_EQ(iceoryx->at("count").get<int>() + iceoryx->at("missing").get<int>(), 200);
  EXPECT_NE(find_series(result, "iceoryx", "raw"), nullptr);
}

TEST(Latency, ItsPageShowsTheTableThePercentilesAndTheHistogramsOverTime) {
  const TestFolder folder;
  ASSERT_EQ(measure({"--report", folder.path("a.html"), "--cpu-producer", "999"}).code, 0);
  const std::string page = testing::read_file(folder.path("a.html"));
  for (const char* load : {"<script src", "<img", "href=\"http", "url(", "@import", "<link"}) {
    EXPECT_EQ(page.find(load), std::string::npos) << load;
  }
  const json data = testing::data_of(page);
  const json* const seen = find_series(data, "seen", "intended");
  ASSERT_NE(seen, nullptr);
  int cells = 0;
  for (const json& cell : seen->at("over_time").at("cells")) cells += cell[2].get<int>();
  EXPECT_EQ(cells, 200);
  EXPECT_GT(seen->at("curve").size(), 10U);
  REQUIRE_BROWSER();
  const json facts = testing::facts_of(folder, page, "latency/page_facts.js", "");
  ASSERT_TRUE(facts.is_object());
  ASSERT_EQ(facts.at("warnings").size(), 1U);
  EXPECT_NE(facts["warnings"][0].get<std::string>().find("CPU 999"), std::string::npos);
  const std::size_t series = data.at("series").size();
  EXPECT_EQ(facts.at("stages").size(), series);
  EXPECT_GE(facts.at("few").get<std::size_t>(), 8 * 4U);
  EXPECT_EQ(facts.at("foreign"), 0);
  ASSERT_EQ(facts.at("plots").size(), 5U);
  const json& percentiles = facts["plots"][0];
  EXPECT_EQ(percentiles.at("name"), "percentiles");
  EXPECT_EQ(percentiles.at("series"), series);
  EXPECT_EQ(percentiles.at("shares")[0], "0 %");
  EXPECT_EQ(percentiles["shares"][1], "50 %");
  for (const json& plot : facts["plots"]) {
    EXPECT_EQ(plot.at("canvases"), 2) << plot;
    EXPECT_GE(plot.at("ticks"), 2) << plot;
  }
  EXPECT_EQ(facts["plots"][4].at("name"), "seen");
  EXPECT_EQ(facts["plots"][4].at("cells"), seen->at("over_time").at("cells").size());
}

}  // namespace
}  // namespace splinecast::apps
