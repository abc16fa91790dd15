#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/process/exit_codes.hpp"
#include "apps/replay/player.hpp"
#include "tests/fixtures/curves/mesh.hpp"
#include "tests/fixtures/curves/recordings.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {
namespace {

using testing::Ended;
using testing::Process;
using testing::run;

/// `replay --verify` with real processes.
class ReplayVerify : public ::testing::Test {
 protected:
  [[nodiscard]] std::string recording(std::size_t knots) const {
    return folder_.write("a.csv", testing::to_csv(testing::random_mesh(4, knots, 2, 4)));
  }
  static void expect_equal(const Ended& replayed, std::size_t segments) {
    EXPECT_EQ(replayed.code, kOk) << replayed.err;
    const auto report = nlohmann::json::parse(replayed.out);
    EXPECT_EQ(report["verification"]["equal"], segments);
    EXPECT_TRUE(report["verification"]["difference"].is_null());
  }

  testing::TestFolder folder_;
  testing::TestStream stream_;
};

TEST_F(ReplayVerify, FindsARecordedStreamEqual) {
  Process solver({"solve", stream_.name()});
  solver.await_message("waiting");
  expect_equal(run({"replay", recording(6000), "--stream", stream_.name(), "--rate", "max",
                    "--clock", "recorded", "--gap", "bridge", "--verify", "--json"}),
               5999);
}

TEST_F(ReplayVerify, FindsALiveStreamEqual) {
  Process solver({"solve", stream_.name()});
  solver.await_message("waiting");
  const Ended replayed = run({"replay", recording(40), "--stream", stream_.name(), "--rate", "20",
                              "--on-error", "skip", "--verify", "--json"});
  EXPECT_EQ(replayed.code, kOk) << replayed.err;
  const auto report = nlohmann::json::parse(replayed.out);
  EXPECT_GT(report["verification"]["equal"], 0);
  EXPECT_TRUE(report["verification"]["difference"].is_null());
}

TEST_F(ReplayVerify, FindsAnEmbeddedSolversStreamEqual) {
  expect_equal(
      run({"replay", recording(500), "--stream", stream_.name(), "--rate", "max", "--clock",
           "recorded", "--embedded", "--method", "akima", "--gap", "bridge", "--verify", "--json"}),
      499);
}

TEST(ReplayExitCode, ReportsADifference) {
  EXPECT_EQ(exit_code({}), kOk);
  EXPECT_EQ(exit_code({.verification = ipc::Verification{.equal = 3}}), kOk);
  EXPECT_EQ(exit_code({.stopped = RefusedBy::solver, .verification = ipc::Verification{}}),
            kFailed);
  EXPECT_EQ(exit_code({.stopped = RefusedBy::solver,
                       .verification = ipc::Verification{.equal = 3, .first = ipc::Difference{}}}),
            kFellShort);
}

}  // namespace
}  // namespace splinecast::apps
