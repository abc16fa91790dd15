#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/ipc/c/every_pointer.hpp"

/// Every pointer of every function, null, misaligned, or to something else.
namespace splinecast::testing {
namespace {

TEST_F(CPointers, ThatAreWrongAreErrorsThatNameTheArgument) {
  for (const auto& wrong : wrong_.calls) {
    SCOPED_TRACE(wrong.function + ", " + wrong.argument + ", " + wrong.kind);
    EXPECT_EQ(splinecast_remove("/"), SPLINECAST_ERROR_ARGUMENT);  // replaces the message
    EXPECT_EQ(wrong.call(), SPLINECAST_ERROR_ARGUMENT);
    EXPECT_EQ(std::string(splinecast_last_error()).find(wrong.argument), 0U)
        << splinecast_last_error();
  }
}

/// The word at the end of a text.
std::string last_word(const std::string& text) { return text.substr(text.find_last_of(" *") + 1); }

/// Each function of the header, and its parameters.
std::vector<std::pair<std::string, std::vector<std::string>>> prototypes(
    const std::string& header) {
  const std::string mark = "\nSPLINECAST_API ";
  std::vector<std::pair<std::string, std::vector<std::string>>> found;
  for (auto at = header.find(mark); at != std::string::npos; at = header.find(mark, at + 1)) {
    const auto open = header.find('(', at);
    std::istringstream list(header.substr(open + 1, header.find(')', open) - open - 1));
    auto& [name, parameters] = found.emplace_back();
    name = last_word(header.substr(at, open - at));
    for (std::string parameter; std::getline(list, parameter, ',');) {
      parameters.push_back(parameter);
    }
  }
  return found;
}

TEST_F(CPointers, OfEveryFunctionOfTheHeaderAreTried) {
  std::set<std::tuple<std::string, std::string, std::string>> tried;
  for (const auto& wrong : wrong_.calls) tried.emplace(wrong.function, wrong.argument, wrong.kind);
  const std::string header =
      read_file(std::string(SPLINECAST_SOURCE) + "/ipc/include/splinecast.h");
  int functions = 0, pointers = 0;
  for (const auto& [function, parameters] : prototypes(header)) {
    ++functions;
    for (const std::string& parameter : parameters) {
      if (parameter.find('*') == std::string::npos) continue;
      ++pointers;
      const std::string name = last_word(parameter);
      const bool is_bytes = parameter.find("char*") != std::string::npos ||
                            parameter.find("uint8_t*") != std::string::npos;
      const bool is_tried = tried.contains({function, name, is_bytes ? "null" : "misaligned"}) ||
                            tried.contains({function, name, "long"});
      EXPECT_TRUE(is_tried) << function << ": " << parameter;
    }
  }
  EXPECT_GE(functions, 87);
  EXPECT_GE(pointers, 135);
}

TEST_F(CPointers, ThatMayBeNullAreAccepted) {
  EXPECT_EQ(splinecast_producer_destroy(nullptr), 0);
  EXPECT_EQ(splinecast_solver_destroy(nullptr), 0);
  EXPECT_EQ(splinecast_reader_destroy(nullptr), 0);
  EXPECT_EQ(splinecast_snapshot_destroy(nullptr), 0);
  EXPECT_EQ(splinecast_curve_destroy(nullptr), 0);
  EXPECT_EQ(splinecast_rate_commander_destroy(nullptr), 0);
  const splinecast_times none = {};
  const splinecast_output_matrix no_values = {};
  EXPECT_EQ(splinecast_reader_sample_many(c_.reader, &none, 15, &no_values, nullptr, 0, nullptr),
            1);
  const splinecast_state unwanted = {};
  EXPECT_EQ(splinecast_reader_sample(c_.reader, 0, &unwanted), SPLINECAST_SAMPLE_SETTLED);
}

}  // namespace
}  // namespace splinecast::testing
