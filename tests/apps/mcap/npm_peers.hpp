#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/fixtures/processes/built_with.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::testing {

/// Tests with other implementations of MCAP, which npm installs once, in the build folder. Where it
/// cannot, they are skipped, and with CI=true they fail: there a registry is always expected.
class NpmPeersTest : public ::testing::Test {
 protected:
  void SetUp() override {
    REQUIRE_MCAP();
    const std::string source = std::string(SPLINECAST_SOURCE) + "/tests/apps/mcap/peers/install.sh";
    const Ended ended = Process(source, {folder_}).wait();
    if (ended.code == 0) return;
    const std::string said = "npm cannot install the peers of MCAP: " + ended.err;
    const char* const ci = std::getenv("CI");
    if (ci != nullptr && std::string(ci) == "true") FAIL() << said;
    GTEST_SKIP() << said;
  }

  /// Runs a script of tests/apps/mcap/peers.
  [[nodiscard]] Ended peer(const std::string& script, std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), folder_ + "/" + script);
    return Process("/usr/bin/node", arguments).wait();
  }

 private:
  std::string folder_ =
      std::filesystem::path(SPLINECAST_PROGRAM).parent_path().parent_path() / "npm";
};

}  // namespace splinecast::testing
