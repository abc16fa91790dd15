#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/fixtures/processes/process.hpp"

/// Recordings that are longer than the memory of a replay.
namespace splinecast::apps {
namespace {

using nlohmann::json;

constexpr int kRows = 150'000;
constexpr int kDimensions = 64;

/// Writes a file whose values need 77 MB in memory.
std::string write_long(const std::string& path) {
  std::ofstream file(path);
  file << "t_ns";
  for (int d = 0; d < kDimensions; ++d) file << ",x" << d;
  std::string row;
  for (int i = 0; i < kRows; ++i) {
    row = fmt::format("\n{}", i * 1'000'000LL);
    for (int d = 0; d < kDimensions; ++d) {
      row += ',';
      row += static_cast<char>('0' + (i + d) % 10);
    }
    file << row;
  }
  file << '\n';
  return path;
}

/// Runs a command of a shell in which `splinecast` is "$0".
testing::Ended in_shell(const std::string& command, const std::vector<std::string>& arguments) {
  std::vector<std::string> all{"-c", command, SPLINECAST_PROGRAM};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return testing::Process("/bin/sh", all).wait();
}

class LongRecording : public ::testing::Test {
 protected:
  void expect_replayed(const testing::Ended& ended) const {
    ASSERT_EQ(ended.code, 0) << ended.err;
    const json report = json::parse(ended.out);
    EXPECT_EQ(report["interpolated"], kRows);
    EXPECT_EQ(testing::info(stream_.name())["solver"]["interpolated"], kRows);
  }
  testing::TestFolder folder_;
  testing::TestStream stream_;
};

TEST_F(LongRecording, IsReplayedWithoutBeingHeldInMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs more data than the limit";
#endif
  // The limit counts heap and other private memory in KiB; the program keeps at most 52 MiB of
  // rows.
  expect_replayed(in_shell(
      "ulimit -d 70000; exec \"$0\" replay \"$1\" --stream \"$2\" --clock recorded --rate max "
      "--embedded --json",
      {write_long(folder_.path("long.csv")), stream_.name()}));
}

TEST_F(LongRecording, ComesThroughAPipe) {
  expect_replayed(in_shell(
      "\"$0\" replay - --stream \"$2\" --clock recorded --rate max --embedded --json < \"$1\"",
      {write_long(folder_.path("long.csv")), stream_.name()}));
  testing::TestStream piped;
  const testing::Ended ended = in_shell(
      "cat \"$1\" | TMPDIR=/nonexistent \"$0\" replay - --stream \"$2\" --clock recorded --rate "
      "max --embedded --json",
      {folder_.path("long.csv"), piped.name()});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(json::parse(ended.out)["interpolated"], kRows);
}

}  // namespace
}  // namespace splinecast::apps
