#include "apps/machine/left_names.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "ipc/mapping/owner_lock.hpp"
#include "splinecast/errors.hpp"
#include "tests/fixtures/processes/private_shared_memory.hpp"
#include "tests/fixtures/processes/process.hpp"

/// Names in /dev/shm whose owners have ended: `doctor` removes them.
namespace splinecast::apps {
namespace {

using testing::PrivateSharedMemory;
using testing::TestStream;

TEST(Doctor, DistinguishesLivingFromDeadNames) {
  const TestStream stream;
  EXPECT_THROW((void)look_at_name(stream.name()), NoSuchStream);
  {
    const ipc::OwnerLock lock(stream.name(), ipc::RegionKind::spline);
    EXPECT_EQ(look_at_name(stream.name()).state, NameState::living);
  }
  EXPECT_EQ(look_at_name(stream.name()).state, NameState::dead);
}

class DoctorVerb : public ::testing::Test {
 protected:
  void SetUp() override {
    REQUIRE_PRIVATE_SHARED_MEMORY();
    std::filesystem::permissions(folder_.path(""), std::filesystem::perms(0755));
    file_ = folder_.write("a.csv", "t,x\n0,1\n0.1,2\n0.2,1\n");
  }
  [[nodiscard]] std::vector<std::string> replay(const std::string& stream) const {
    return {"replay",   file_,    "--stream", stream,      "--clock",
            "recorded", "--rate", "max",      "--embedded"};
  }
  testing::TestFolder folder_;
  std::string file_;
};

TEST_F(DoctorVerb, RemovesOnlyNamesWhoseOwnersAreProvenDead) {
  const PrivateSharedMemory memory("64m");
  ASSERT_EQ(memory.run(replay("dead"), {}).code, 0);
  ASSERT_EQ(mkfifo(memory.file("splinecast.fifo.spline").c_str(), 0600), 0);
  testing::Process solver = memory.start({"solve", "living"}, {});
  solver.await_message("waiting for a producer");
  const auto before = memory.listing();
  const auto looked = memory.run({"doctor"}, {});
  EXPECT_EQ(looked.code, 1) << looked.out;  // the FIFO
  for (const char* text :
       {"stream dead", "its writers have ended", "splinecast doctor dead --clean", "stream living",
        "has a living writer", "splinecast.fifo.spline is not a regular file"}) {
    EXPECT_NE(looked.out.find(text), std::string::npos) << text << " in " << looked.out;
  }
  EXPECT_EQ(memory.listing(), before);
  const auto cleaned = memory.run({"doctor", "--clean", "--json"}, {});
  EXPECT_EQ(cleaned.code, 1);
  const auto report = nlohmann::json::parse(cleaned.out);
  EXPECT_EQ(report["problems"], 1);
  EXPECT_TRUE(std::ranges::any_of(report["findings"], [](const nlohmann::json& finding) {
    return finding["check"] == "stream dead" && finding["verdict"] == "ok" &&
           finding["means"].get<std::string>().find("removed") != std::string::npos;
  })) << cleaned.out;
  auto left = before;
  std::erase_if(left, [](const auto& file) { return file.first.starts_with("splinecast.dead."); });
  EXPECT_EQ(memory.listing(), left);
}

TEST_F(DoctorVerb, ChecksOnlyTheNamedStream) {
  const PrivateSharedMemory memory("64m");
  ASSERT_EQ(memory.run(replay("one"), {}).code, 0);
  ASSERT_EQ(memory.run(replay("two"), {}).code, 0);
  const auto ended = memory.run({"doctor", "one", "--clean"}, {});
  EXPECT_EQ(ended.code, 0) << ended.out;
  EXPECT_EQ(ended.out.find("stream two"), std::string::npos) << ended.out;
  EXPECT_EQ(memory.run({"info", "one"}, {}).code, 4);
  EXPECT_EQ(memory.run({"info", "two"}, {}).code, 0);
  EXPECT_EQ(memory.run({"doctor", "three"}, {}).code, 4);
  EXPECT_EQ(memory.run({"doctor", "a/b"}, {}).code, 2);
}

TEST_F(DoctorVerb, KeepsTheNamesOfOtherUsers) {
  REQUIRE_ROOT();
  const PrivateSharedMemory memory("64m");
  ASSERT_EQ(memory.run(replay("theirs"), {.user = 12345, .group = 12345}).code, 0);
  const auto before = memory.listing();
  const auto ended = memory.run({"doctor", "--clean"}, {});
  EXPECT_EQ(ended.code, 0) << ended.out;
  EXPECT_NE(ended.out.find("belongs to user 12345: not changed"), std::string::npos) << ended.out;
  EXPECT_EQ(memory.listing(), before);
}

}  // namespace
}  // namespace splinecast::apps
