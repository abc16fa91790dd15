#include "apps/latency/compare.hpp"

#include <gtest/gtest.h>

#include <string>

#include "apps/process/exit_codes.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;
using testing::run;
using testing::TestFolder;

ordered_json percentile(double percent, int ns, bool enough) {
  return {{"percent", percent}, {"ns", ns}, {"above", enough ? 10 : 9}, {"enough", enough}};
}

/// A result with one stage, the floor and a peer.
ordered_json result(int p50, int p99, bool enough = true) {
  return {{"splinecast_latency", 1},
          {"environment", {{"cpu", "A"}}},
          {"options", {{"rate", 1000}}},
          {"series",
           {{{"name", "seen"},
             {"from", "intended"},
             {"percentiles", {percentile(50, p50, true), percentile(99, p99, enough)}}},
            {{"name", "floor"}, {"from", "raw"}, {"percentiles", {percentile(50, 60, true)}}},
            {{"name", "iceoryx"}, {"from", "raw"}, {"percentiles", {percentile(50, 60, true)}}}}}};
}

TEST(LatencyCompare, ARegressionExceedsTheThresholdAndTheLeastDifference) {
  const auto regressions = [](int a, int b) {
    return compare_latencies(result(a, 90'000), result(b, 90'000), 20, 1000).regressions();
  };
  EXPECT_EQ(regressions(50'000, 60'000), 0U);
  EXPECT_EQ(regressions(50'000, 60'001), 1U);
  EXPECT_EQ(regressions(60'001, 50'000), 0U);
  EXPECT_EQ(regressions(1000, 2000), 0U);  // twice as long, by 1 µs
  EXPECT_EQ(regressions(1000, 2001), 1U);
}

TEST(LatencyCompare, LooksOnlyAtPercentilesThatHaveEnoughSamplesInBoth) {
  const auto found =
      compare_latencies(result(50'000, 90'000), result(50'000, 900'000, false), 20, 0);
  ASSERT_EQ(found.percentiles.size(), 1U);
  EXPECT_EQ(found.percentiles[0].percent, 50);
  EXPECT_EQ(found.regressions(), 0U);
  ordered_json none = result(50'000, 90'000, false);
  none["series"][0]["percentiles"][0]["enough"] = false;
  EXPECT_THROW((void)compare_latencies(none, none, 20, 0), InputError);
}

TEST(LatencyCompare, AnotherMachineIsADifferenceAndNotARegression) {
  const ordered_json a = result(50'000, 90'000);
  EXPECT_TRUE(compare_latencies(a, a, 20, 0).differences.empty());
  ordered_json b = a;
  b["environment"]["cpu"] = "B";
  b["options"]["rate"] = 2000;
  for (const std::size_t of_machine : {1U, 2U}) {
    b["series"][of_machine]["percentiles"][0]["ns"] = 120;
  }
  const auto found = compare_latencies(a, b, 20, 0);
  EXPECT_EQ(found.regressions(), 0U);
  ASSERT_EQ(found.differences.size(), 3U);
  EXPECT_EQ(found.differences[0], "environment cpu: A in A, B in B");
  EXPECT_EQ(found.differences[1], "option rate: 1000 in A, 2000 in B");
  EXPECT_EQ(found.differences[2], "floor at 50 %: 60 ns in A, 120 ns in B");
}

TEST(LatencyCompare, ExitsWith3OnARegressionAndWith2OnAnInvalidResult) {
  const TestFolder folder;
  const auto a = folder.write("a.json", result(50'000, 90'000).dump());
  const auto b = folder.write("b.json", result(50'000, 110'000).dump());
  const auto compare = [](const std::vector<std::string>& arguments) {
    std::vector<std::string> all{"latency", "compare"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return run(all);
  };
  EXPECT_EQ(compare({a, a}).code, 0);
  EXPECT_EQ(compare({b, a}).code, 0);
  const auto slower = compare({a, b});
  EXPECT_EQ(slower.code, 3) << slower.err;
  EXPECT_NE(slower.out.find("REGRESSION"), std::string::npos);
  EXPECT_EQ(compare({a, b, "--threshold", "25"}).code, 0);
  EXPECT_EQ(compare({a, b, "--least", "20"}).code, 0);
  const auto listed = compare({a, b, "--json"});
  EXPECT_EQ(listed.code, 3);
  EXPECT_EQ(ordered_json::parse(listed.out).at("regressions"), 1);
  for (const char* const text :
       {"", "{}", "[]", "nonsense", "{\"splinecast_latency\": 0}", "{\"splinecast_latency\": 1}"}) {
    EXPECT_EQ(compare({a, folder.write("c.json", text)}).code, 2) << text;
  }
  EXPECT_EQ(compare({a, folder.path("missing.json")}).code, 2);
  EXPECT_EQ(compare({a}).code, 2);
}

}  // namespace
}  // namespace splinecast::apps
