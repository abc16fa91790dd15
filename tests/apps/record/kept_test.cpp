#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/apps/record/recorded.hpp"
#include "tests/fixtures/processes/shared_files.hpp"

/// The recordings of tests/data/recordings, which former versions of the program have made.
namespace splinecast::testing {
namespace {

void expect_as_made(const std::string& folder) {
  const auto expected = nlohmann::json::parse(read_file(folder + "/expected.json"));
  std::vector<std::string> paths;
  for (const auto& [name, streams] : expected.items()) {
    const std::string& path = paths.emplace_back(folder + "/" + name + ".mcap");
    const Verified found = verify(path);
    EXPECT_EQ(found.code, 0) << path << ": " << found.err;
    ASSERT_TRUE(found.json.is_object()) << path << ": " << found.err;
    EXPECT_EQ(found.json["streams"].size(), streams.size()) << path;
    for (const auto& [stream, segments] : streams.items()) {
      EXPECT_EQ(found.stream(stream)["segments"], segments) << path;
      EXPECT_EQ(found.stream(stream)["equal"], segments) << path;
    }
  }
  EXPECT_EQ(recordings_in(folder), paths);
}

TEST(KeptRecordings, VerifyAsTheyDidWhenTheyWereMade) {
  expect_as_made(own_file("recordings"));
  expect_as_made(own_file("recordings/layout_7"));
}

}  // namespace
}  // namespace splinecast::testing
