#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "ipc/memory/word.hpp"
#include "tests/fixtures/curves/mesh.hpp"
#include "tests/fixtures/curves/recordings.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {

using testing::await;
using testing::Ended;
using testing::info;
using testing::Process;
using testing::run;
using testing::TestStream;

/// A recording, sample times, and the expected samples.
class Life : public ::testing::Test {
 protected:
  Life() {
    const auto mesh = testing::random_mesh(4, 2000, 2, 1);
    file_ = folder_.write("a.csv", testing::to_csv(mesh));
    at_ = folder_.write("at.csv", testing::times_csv(mesh, 2));
    wanted_ = testing::run({"fit", file_, "--online", "--at", at_}).out;
  }
  [[nodiscard]] std::vector<std::string> solve() const { return {"solve", name()}; }
  [[nodiscard]] std::vector<std::string> replay() const {
    return {"replay", file_, "--stream", name(), "--rate", "max", "--clock", "recorded"};
  }
  [[nodiscard]] std::vector<std::string> sample() const { return {"sample", name(), "--at", at_}; }
  [[nodiscard]] const std::string& name() const { return stream_.name(); }
  [[nodiscard]] ipc::Word field(const char* role, const char* key) const {
    const auto now = testing::info(name());
    return now.contains(role) && now[role].is_object() ? now[role][key].get<ipc::Word>() : 0;
  }
  void expect_all_sampled(testing::Process& sampling) const {
    const testing::Ended sampled = sampling.wait();
    EXPECT_EQ(sampled.code, 0) << sampled.err;
    EXPECT_TRUE(testing::same_text(testing::without_status(sampled.out), wanted_));
  }
  static void expect_all_sent(testing::Process& replaying) {
    const testing::Ended sent = replaying.wait();
    EXPECT_EQ(sent.code, 0) << sent.err;
    EXPECT_NE(sent.err.find("2000 waypoints sent, 2000 interpolated, 0 refused"), std::string::npos)
        << sent.err;
  }

  testing::TestFolder folder_;
  testing::TestStream stream_;
  std::string file_, at_, wanted_;
};

}  // namespace splinecast::apps
