#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/batch/c2.hpp"
#include "splinecast/fit.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

namespace splinecast::core {
namespace {

using nlohmann::json;

/// A case and the file that contains it. A file of this project contains several cases by name, a
/// shared file only one.
struct Case {
  std::string name;
  std::filesystem::path path;
  bool is_own;
};

void PrintTo(const Case& tested, std::ostream* out) { *out << tested.name; }

std::vector<std::filesystem::path> json_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::is_directory(folder)) return files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

/// The cases that tests/golden/golden.py computes.
std::vector<Case> own_cases() {
  std::vector<Case> cases;
  for (const auto& path : json_files(SPLINECAST_SOURCE "/tests/golden")) {
    const json file = json::parse(std::ifstream(path));
    for (const auto& [name, content] : file.items()) cases.push_back({name, path, true});
  }
  return cases;
}

/// The cases of the shared folder; if it has none, one case "none", which is skipped.
std::vector<Case> shared_cases() {
  std::vector<Case> cases;
  for (const auto& path : json_files(testing::shared_file("golden"))) {
    cases.push_back({path.stem(), path, false});
  }
  if (cases.empty()) cases.push_back({"none", testing::shared_file("golden/none.json"), false});
  return cases;
}

Condition condition(const json& golden, const char* end) {
  if (!golden.contains(end)) return {ConditionKind::own, {}};
  const std::string kind = golden.at(end).at(0);
  Condition condition = kind == "velocity"       ? Condition{ConditionKind::velocity, {}}
                        : kind == "acceleration" ? Condition{ConditionKind::acceleration, {}}
                                                 : parse_condition(kind).value();
  const json& value = golden.at(end).at(1);
  if (!value.is_null()) condition.value = value.get<std::vector<double>>();
  return condition;
}

std::vector<double> flat(const json& golden, const char* name) {
  std::vector<double> values;
  if (!golden.contains(name)) return values;
  for (const json& row : golden.at(name)) {
    for (const double x : row) values.push_back(x);
  }
  return values;
}

double largest(const json& array) {
  if (array.is_number()) return std::abs(array.get<double>());
  double most = 0;
  for (const json& item : array) most = std::max(most, largest(item));
  return most;
}

/// `shortest` is the shortest interval in s. The tolerance is at least the rounding error of the
/// velocities divided by `shortest` for accelerations, and by its square for jerks, because the
/// expected values may be only rounding errors.
void expect_samples(const PiecewisePolynomial& curve, const json& golden, double shortest) {
  const std::size_t dimensions = curve.dimensions();
  const json& expected = golden.at("expected");
  const char* const names[] = {"p", "v", "a", "j"};
  State state(dimensions);
  for (std::size_t q = 0; q < golden.at("query_ns").size(); ++q) {
    curve.evaluate(Time(golden.at("query_ns").at(q).get<std::int64_t>()), state.ref());
    for (std::size_t k = 0; k < 4; ++k) {
      const double rounding = 1e-12 * largest(expected.at("v")) / shortest / shortest;
      const double tolerance = std::max(1e-9 * largest(expected.at(names[k])),
                                        k < 2 ? 0 : rounding * (k < 3 ? shortest : 1));
      for (std::size_t d = 0; d < dimensions; ++d) {
        ASSERT_NEAR(state.values()[k * dimensions + d],
                    expected.at(names[k]).at(q).at(d).get<double>(), tolerance)
            << names[k] << " at query " << q << ", dimension " << d;
      }
    }
  }
}

void expect_segments(const PiecewisePolynomial& curve, const json& golden) {
  const json& expected = golden.at("expected").at("segments");
  const double tolerance = 1e-9 * largest(expected);
  ASSERT_EQ(curve.segments(), expected.size());
  for (std::size_t i = 0; i < curve.segments(); ++i) {
    for (std::size_t d = 0; d < curve.dimensions(); ++d) {
      const json& coefficients = expected.at(i).at(d);
      const auto order = static_cast<std::size_t>(curve.order_of(i));
      ASSERT_EQ(coefficients.size(), order);
      for (std::size_t k = 0; k < order; ++k) {
        ASSERT_NEAR(curve.coefficients(i)[(order - 1 - k) * curve.dimensions() + d],
                    coefficients.at(k).get<double>(), tolerance)
            << "segment " << i << ", dimension " << d << ", coefficient " << k;
      }
    }
  }
}

class Golden : public ::testing::TestWithParam<Case> {};

TEST_P(Golden, AgreesTo1eMinus9OfTheLargestValue) {
  REQUIRE_SHARED_FILE(GetParam().path);
  const json file = json::parse(std::ifstream(GetParam().path));
  const json& golden = GetParam().is_own ? file.at(GetParam().name) : file;
  std::vector<Time> times;
  for (const std::int64_t t : golden.at("t_ns")) times.emplace_back(t);
  const auto positions = flat(golden, "x");
  const auto velocities = flat(golden, "v");
  const auto accelerations = flat(golden, "a");
  const Waypoints waypoints{.dimensions = golden.at("x").at(0).size(),
                            .times = times,
                            .positions = positions,
                            .velocities = velocities,
                            .accelerations = accelerations};
  const std::string name = golden.at("method");
  FitOptions options;
  options.interpolant.method = find_method(name);
  ASSERT_NE(options.interpolant.method, nullptr) << name;
  options.interpolant.lambda = golden.value("lambda", 0.0);
  options.start = condition(golden, "start");
  options.end = condition(golden, "end");

  const auto curve = fit(waypoints, options);
  double shortest = 1;
  for (std::size_t i = 1; i < times.size(); ++i) {
    shortest = std::min(shortest, to_seconds(times[i] - times[i - 1]));
  }
  expect_samples(curve, golden, shortest);
  expect_segments(curve, golden);
  if (name != "c2") return;
  const auto other = c2_spline(waypoints, options.start, options.end, C2Form::acceleration);
  expect_samples(other, golden, shortest);
  expect_segments(other, golden);
}

std::string test_name(const ::testing::TestParamInfo<Case>& tested) {
  std::string name = tested.param.name;
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Computed, Golden, ::testing::ValuesIn(own_cases()), test_name);
INSTANTIATE_TEST_SUITE_P(Shared, Golden, ::testing::ValuesIn(shared_cases()), test_name);

}  // namespace
}  // namespace splinecast::core
