#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "splinecast/core/c2_spline.hpp"
#include "support/shared_files.hpp"

namespace splinecast::core {
namespace {

using nlohmann::json;

class Golden : public ::testing::TestWithParam<const char*> {
 protected:
  static Condition condition(const json& pair) {
    const std::string kind = pair.at(0);
    Condition condition = kind == "velocity"       ? Condition{ConditionKind::velocity, {}}
                          : kind == "acceleration" ? Condition{ConditionKind::acceleration, {}}
                                                   : parse_condition(kind).value();
    if (!pair.at(1).is_null()) condition.value = pair.at(1).get<std::vector<double>>();
    return condition;
  }
};

double largest(const json& array) {
  if (array.is_number()) return std::abs(array.get<double>());
  double most = 0;
  for (const json& item : array) most = std::max(most, largest(item));
  return most;
}

TEST_P(Golden, AgreesTo1eMinus9OfTheLargestValue) {
  const auto path = testing::shared_file(std::string("golden/") + GetParam() + ".json");
  REQUIRE_SHARED_FILE(path);
  const json golden = json::parse(std::ifstream(path));
  std::vector<Time> times;
  for (const std::int64_t t : golden.at("t_ns")) times.emplace_back(t);
  std::vector<double> positions;
  for (const json& row : golden.at("x")) {
    for (const double x : row) positions.push_back(x);
  }
  const std::size_t dimensions = golden.at("x").at(0).size();
  const auto curve = c2_spline(times, positions, dimensions, condition(golden.at("start")),
                               condition(golden.at("end")));

  const json& expected = golden.at("expected");
  const char* const names[] = {"p", "v", "a", "j"};
  State state(dimensions);
  for (std::size_t q = 0; q < golden.at("query_ns").size(); ++q) {
    curve.evaluate(Time(golden.at("query_ns").at(q).get<std::int64_t>()), state.ref());
    for (std::size_t k = 0; k < 4; ++k) {
      const double tolerance = 1e-9 * std::max(largest(expected.at(names[k])), 1e-300);
      for (std::size_t d = 0; d < dimensions; ++d) {
        EXPECT_NEAR(state.values()[k * dimensions + d],
                    expected.at(names[k]).at(q).at(d).get<double>(), tolerance)
            << names[k] << " at query " << q << ", dimension " << d;
      }
    }
  }
  const double tolerance = 1e-9 * largest(expected.at("segments"));
  ASSERT_EQ(curve.segments(), expected.at("segments").size());
  for (std::size_t i = 0; i < curve.segments(); ++i) {
    for (std::size_t d = 0; d < dimensions; ++d) {
      for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_NEAR(curve.coefficients(i)[(3 - k) * dimensions + d],
                    expected.at("segments").at(i).at(d).at(k).get<double>(), tolerance);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    C2, Golden,
    ::testing::Values(
        "c2-acceleration-acceleration-n25-d7-jitter", "c2-acceleration-acceleration-n40-d3-wild",
        "c2-acceleration-acceleration-n6-d1-jitter", "c2-natural-acceleration-n25-d7-jitter",
        "c2-natural-acceleration-n40-d3-wild", "c2-natural-acceleration-n6-d1-jitter",
        "c2-natural-n2", "c2-natural-n3", "c2-natural-natural-n25-d7-jitter",
        "c2-natural-natural-n40-d3-wild", "c2-natural-natural-n6-d1-jitter",
        "c2-velocity-natural-n25-d7-jitter", "c2-velocity-natural-n40-d3-wild",
        "c2-velocity-natural-n6-d1-jitter", "c2-velocity-rest-n2", "c2-velocity-rest-n25-d7-jitter",
        "c2-velocity-rest-n3", "c2-velocity-rest-n40-d3-wild", "c2-velocity-rest-n6-d1-jitter",
        "c2-velocity-velocity-n25-d7-jitter", "c2-velocity-velocity-n40-d3-wild",
        "c2-velocity-velocity-n6-d1-jitter"));

}  // namespace
}  // namespace splinecast::core
