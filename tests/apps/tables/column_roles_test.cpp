#include "apps/tables/column_roles.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "apps/tables/waypoints.hpp"
#include "tests/fixtures/processes/allocations.hpp"
#include "tests/fixtures/processes/process.hpp"

/// The roles of columns, from their names.
namespace splinecast::apps {
namespace {

using testing::TestFolder;

/// Reads a CSV with a header and one row of as many numbers.
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
  std::string said_;  ///< text on standard error, or of the error
};

TEST_F(ColumnRolesTest, InvalidTimeOrDerivativeColumnsAreRefusedByName) {
  expect_refused("t,x,v[-1]",
                 "column 3, 'v[-1]', is not a valid velocity: v[i] has an index i from 0 to 63");
  expect_refused("t,x,v[18446744073709551616]",
                 "column 3, 'v[18446744073709551616]', is not a valid velocity");
  expect_refused("t,a[],x", "column 2, 'a[]', is not a valid acceleration");
  expect_refused("t,x,a[1.5]", "column 3, 'a[1.5]', is not a valid acceleration");
  expect_refused("t,x,v[7]", "column 3, 'v[7]', belongs to none of the 1 positions (x)");
  expect_refused("t,x,v[0],v[1]", "column 4, 'v[1]', belongs to none of the 1 positions (x)");
  expect_refused("t_ns,x,time", "column 3, 'time', is a second time column after 't_ns'");
  EXPECT_EQ(read("t_ns,x,time,v[-1],v[7]", {"x"}).names, std::vector<std::string>{"x"});
  EXPECT_EQ(read("t_ns,x,time", {"x", "time"}).dimensions(), 2U);
}

TEST_F(ColumnRolesTest, AreReportedIfNamesAreAmbiguous) {
  EXPECT_EQ(read("t,x,vx,ax").names, (std::vector<std::string>{"x", "vx", "ax"}));
  EXPECT_NE(said_.find("a.csv: time: t; positions: x, vx, ax; velocities: none; accelerations: "
                       "none"),
            std::string::npos)
      << said_;
  (void)read("t,q1 [rad],v[0],time_sync");
  EXPECT_EQ(said_.find("is a second time"), std::string::npos);
  for (const char* const clear : {"t,x,y,z", "t,q1 [rad],q2 [rad]", "t_ns,p[0],v[0],a[0],j[0]"}) {
    (void)read(clear);
    EXPECT_EQ(said_, "") << clear;
  }
  (void)read("t,x,vx", {"x"});
  EXPECT_EQ(said_, "");
}

TEST_F(ColumnRolesTest, TooManyPositionsAreReportedWithTheFirstExcessColumn) {
  std::string header = "t";
  for (int i = 0; i < 64; ++i) header += fmt::format(",x{}", i);
  EXPECT_EQ(read(header).dimensions(), 64U);
  expect_refused(header + ",x64,x65",
                 "column 66, 'x64', would be the position of dimension 65; the maximum is 64");
}

/// Measures the work by allocations, which grow with the fields that are read: a row is split once,
/// not once per column.
TEST_F(ColumnRolesTest, AreFoundWithWorkLinearInTheColumns) {
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
