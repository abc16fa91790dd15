#include "support/column_roles.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/allocations.hpp"
#include "support/process.hpp"
#include "support/waypoint_table.hpp"

/// What columns become by their names.
namespace splinecast::apps {
namespace {

using testing::TestFolder;

/// A header and a row of as many numbers.
class ColumnRolesTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& header) const {
    std::string row = "0";
    for (const char c : header) row += c == ',' ? ",1" : "";
    return folder_.write("a.csv", header + "\n" + row + "\n");
  }
  WaypointTable read(const std::string& header, const std::vector<std::string>& columns = {}) {
    ::testing::internal::CaptureStderr();
    try {
      WaypointTable table = read_waypoints(file(header), {.columns = columns});
      said_ = ::testing::internal::GetCapturedStderr();
      return table;
    } catch (const InputError& error) {
      ::testing::internal::GetCapturedStderr();
      said_ = error.what();
    }
    return {};
  }
  void expect_refused(const std::string& header, const std::string& message) {
    EXPECT_EQ(read(header).size(), 0U) << header;
    EXPECT_NE(said_.find("a.csv: " + message), std::string::npos) << header << ": " << said_;
  }

  TestFolder folder_;
  std::string said_;  ///< on standard error, or by the error
};

TEST_F(ColumnRolesTest, TooManyPositionsAreToldByTheFirstColumnBeyond) {
  std::string header = "t";
  for (int i = 0; i < 64; ++i) header += fmt::format(",x{}", i);
  EXPECT_EQ(read(header).dimensions(), 64U);
  expect_refused(header + ",x64,x65",
                 "column 66, 'x64', would be the position of dimension 65; at most 64");
}

/// By the memory it takes, which grows with the fields looked at: a row is split once, not once per
/// column.
TEST_F(ColumnRolesTest, AreFoundWithWorkThatGrowsWithTheColumns) {
  constexpr std::size_t kColumns = 8'000;
  std::string header = "t";
  for (std::size_t i = 0; i < kColumns; ++i) header += fmt::format(",x{}", i);
  const std::size_t before = testing::allocations();
  expect_refused(header, "column 66, 'x64', would be");
  EXPECT_EQ(read(header, {"x7999"}).names, std::vector<std::string>{"x7999"});
  EXPECT_LT(testing::allocations() - before, 6 * kColumns);
}

}  // namespace
}  // namespace splinecast::apps
