#include "apps/cli/nearest.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace splinecast::apps {
namespace {

const std::vector<std::string> kVerbs{"replay", "record", "solve", "rate", "rm", "fit"};

TEST(Nearest, IsTheWordWithTheFewestDifferences) {
  EXPECT_EQ(nearest("replya", kVerbs), "replay");  // exchanged
  EXPECT_EQ(nearest("recrod", kVerbs), "record");
  EXPECT_EQ(nearest("slve", kVerbs), "solve");     // one is missing
  EXPECT_EQ(nearest("ratte", kVerbs), "rate");     // one too many
  EXPECT_EQ(nearest("Replay", kVerbs), "replay");  // replaced
  EXPECT_EQ(nearest("replays2", kVerbs), "replay");
  EXPECT_EQ(nearest("fti", kVerbs), "fit");
}

TEST(Nearest, IsNothingForAnotherWord) {
  EXPECT_EQ(nearest("sideways", kVerbs), std::nullopt);
  EXPECT_EQ(nearest("go", kVerbs), std::nullopt);  // half of it differs from rm
  EXPECT_EQ(nearest("", kVerbs), std::nullopt);
  EXPECT_EQ(nearest("x", kVerbs), std::nullopt);
  EXPECT_EQ(nearest(std::string(100'000, 'r'), kVerbs), std::nullopt);
  EXPECT_EQ(nearest("replay", {}), std::nullopt);
}

}  // namespace
}  // namespace splinecast::apps
