#include "apps/output/stream.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>
#include <vector>

#include "apps/process/exit_codes.hpp"
#include "tests/fixtures/processes/process.hpp"

/// How verbs write their output files.
namespace splinecast::apps {
namespace {

namespace fs = std::filesystem;
using testing::Ended;
using testing::read_file;
using testing::run;
using testing::TestFolder;

class OutputTest : public ::testing::Test {
 protected:
  static void write(const std::string& path, const std::string& text) {
    Output output(path);
    output.write(text);
    output.close();
  }
  [[nodiscard]] std::size_t files() const {
    const fs::directory_iterator all(folder_.path(""));
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
  }

  TestFolder folder_;
};

TEST_F(OutputTest, ThatIsAlsoAnInputIsRefusedAndUnchanged) {
  const std::string rows = "t,x\n0,0\n1,1\n2,0\n";
  const auto file = folder_.write("a.csv", rows);
  const auto link = folder_.path("link.csv");
  const auto other = folder_.path("hard.csv");
  fs::create_symlink("a.csv", link);
  fs::create_hard_link(file, other);
  for (const std::string& output : {file, folder_.path("./a.csv"), link, other}) {
    for (const char* const option : {"-o", "--report"}) {
      const Ended ended = run({"fit", file, "--dt", "1", option, output});
      EXPECT_EQ(ended.code, kBadUsageOrInput) << option << ' ' << output;
      EXPECT_NE(ended.err.find("is an input too"), std::string::npos) << ended.err;
      EXPECT_EQ(read_file(file), rows);
    }
  }
  EXPECT_EQ(run({"fit", link, "--at", other, "-o", file}).code, kBadUsageOrInput);
  EXPECT_EQ(read_file(file), rows);
  const auto report = folder_.path("report.html");
  const Ended twice = run({"fit", file, "--dt", "1", "--report", report, "-o", report});
  EXPECT_EQ(twice.code, kBadUsageOrInput);
  EXPECT_NE(twice.err.find("is given for two outputs"), std::string::npos) << twice.err;
  EXPECT_FALSE(fs::exists(report));
}

TEST_F(OutputTest, OfSampleMustNotBeItsFileOfTimes) {
  const auto at = folder_.write("at.csv", "t\n1\n");
  const Ended ended = run({"sample", "no.such.stream", "--at", at, "-o", at, "--wait", "0"});
  EXPECT_EQ(ended.code, kBadUsageOrInput);
  EXPECT_NE(ended.err.find("is an input too"), std::string::npos) << ended.err;
  EXPECT_EQ(read_file(at), "t\n1\n");
}

TEST_F(OutputTest, IsReplacedAtomicallyAndKeepsItsPermissions) {
  const auto path = folder_.write("a", "old");
  ASSERT_EQ(chmod(path.c_str(), 0640), 0);
  {
    Output dropped(path);
    dropped.write("new");
    dropped.flush();
    EXPECT_EQ(read_file(path), "old");
  }
  EXPECT_EQ(read_file(path), "old");
  write(path, "new");
  EXPECT_EQ(read_file(path), "new");
  EXPECT_EQ(fs::status(path).permissions(), static_cast<fs::perms>(0640));
  EXPECT_EQ(files(), 1U);
}

TEST_F(OutputTest, ThroughASymbolicLinkReplacesItsTargetAndKeepsTheLink) {
  const auto path = folder_.write("a", "old");
  const auto link = folder_.path("link");
  fs::create_symlink("a", link);
  write(link, "new");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(read_file(path), "new");
  const auto dangling = folder_.path("dangling");
  fs::create_symlink("b", dangling);
  write(dangling, "b");
  EXPECT_TRUE(fs::is_symlink(dangling));
  EXPECT_EQ(read_file(folder_.path("b")), "b");
  const auto loop = folder_.path("loop");
  fs::create_symlink("loop", loop);
  EXPECT_THROW(Output{loop}, Failure);
}

TEST_F(OutputTest, ThatGrowsIsReadableBeforeItIsClosed) {
  const auto path = folder_.path("a");
  Output output(path, Writing::growing);
  output.write("row");
  output.flush();
  EXPECT_EQ(read_file(path), "row");
}

TEST_F(OutputTest, ToDevicesIsWrittenDirectly) {
  write("/dev/null", "text");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THROW(write("/dev/full", "text"), Failure);
  EXPECT_THROW(write(folder_.path("none/a"), "text"), Failure);
  EXPECT_THROW(write(folder_.path(""), "text"), Failure);
  const auto rows = folder_.write("a.csv", "t,x\n0,0\n1,1\n");
  EXPECT_EQ(run({"fit", rows, "--dt", "1", "-o", "/dev/stdout"}).out,
            run({"fit", rows, "--dt", "1"}).out);
}

}  // namespace
}  // namespace splinecast::apps
