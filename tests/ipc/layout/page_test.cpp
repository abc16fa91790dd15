#include "ipc/layout/common_control.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "ipc/layout/header.hpp"

/// `docs/layout-fields.md` is generated from the tables of the layout.
namespace splinecast::ipc {
namespace {

constexpr const char* kPagePath = SPLINECAST_SOURCE "/docs/layout-fields.md";

/// If SPLINECAST_WRITE_LAYOUT is set, the test writes the page instead of comparing it.
TEST(LayoutPage, MatchesTheTables) {
  if (std::getenv("SPLINECAST_WRITE_LAYOUT") != nullptr) {
    std::ofstream(kPagePath) << layout_page();
    GTEST_SKIP() << kPagePath << " has been written";
  }
  std::ifstream file(kPagePath);
  std::ostringstream page;
  page << file.rdbuf();
  EXPECT_EQ(page.str(), layout_page())
      << kPagePath << " is out of date; regenerate it with\n  SPLINECAST_WRITE_LAYOUT=1 "
      << "splinecast_tests --gtest_filter=LayoutPage.*";
}

TEST(LayoutPage, StatesItsLayoutVersion) {
  const std::string version = std::to_string(kLayoutVersion);
  EXPECT_NE(layout_page().find("layout version " + version), std::string::npos);
  EXPECT_NE(layout_page().find("32 bits each: " + version + " and"), std::string::npos);
}

TEST(LayoutPage, StatesTheNumberOfControlBlockPositions) {
  const std::string positions = std::to_string(kControlPositions);
  EXPECT_NE(layout_page().find("(stream id mod " + positions + ")"), std::string::npos);
}

}  // namespace
}  // namespace splinecast::ipc
