#include "ipc/layout/common_control.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "ipc/layout/mark.hpp"

/// The page of the layout is written from its tables.
namespace splinecast::ipc {
namespace {

constexpr const char* kPagePath = SPLINECAST_SOURCE "/ipc/layout.md";

/// With SPLINECAST_WRITE_LAYOUT set, the page is written instead.
TEST(LayoutPage, IsWhatTheTablesSay) {
  if (std::getenv("SPLINECAST_WRITE_LAYOUT") != nullptr) {
    std::ofstream(kPagePath) << layout_page();
    GTEST_SKIP() << kPagePath << " has been written";
  }
  std::ifstream file(kPagePath);
  std::ostringstream page;
  page << file.rdbuf();
  EXPECT_EQ(page.str(), layout_page())
      << kPagePath << " is out of date; write it again with\n  SPLINECAST_WRITE_LAYOUT=1 "
      << "splinecast_tests --gtest_filter=LayoutPage.*";
}

TEST(LayoutPage, SaysWhichVersionItIsOf) {
  const std::string version = std::to_string(kLayoutVersion);
  EXPECT_NE(layout_page().find("layout version " + version), std::string::npos);
  EXPECT_NE(layout_page().find("32 bits each: " + version + " and"), std::string::npos);
}

TEST(LayoutPage, SaysHowManyPositionsTheControlBlockMayHave) {
  const std::string positions = std::to_string(kControlPositions);
  EXPECT_NE(layout_page().find("(stream id mod " + positions + ")"), std::string::npos);
}

}  // namespace
}  // namespace splinecast::ipc
