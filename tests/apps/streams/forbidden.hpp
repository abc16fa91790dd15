#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/fixtures/processes/private_shared_memory.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {

/// What stands in the way of a verb, in a /dev/shm of the test's own: each attack must end in a
/// clear error, or be lived with, and leave each file as it was. Counts go to the test's record.
class Forbidden : public ::testing::Test {
 protected:
  using Listing = std::map<std::string, std::string>;

  void SetUp() override {
    REQUIRE_PRIVATE_SHARED_MEMORY();
    // Where a user other than root may look.
    std::filesystem::permissions(folder_.path(""), std::filesystem::perms(0755));
    file_ = folder_.write("moves.csv", "t,x,y\n0,0,1\n0.1,0.2,1\n0.2,0.6,0.8\n0.3,1,0.5\n");
  }

  void TearDown() override {
    RecordProperty("attacks", attacks_);
    RecordProperty("unclear", unclear_);
    RecordProperty("killed", killed_);
    RecordProperty("changed", changed_);
  }

  /// Sends the recording, and waits so many seconds for a solver.
  [[nodiscard]] std::vector<std::string> replay(const std::vector<std::string>& more = {},
                                                const std::string& wait = "0.1") const {
    std::vector<std::string> all{"replay",   file_,    "--stream", "a",      "--clock",
                                 "recorded", "--rate", "max",      "--wait", wait};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  /// One attack: the verb must end with this code and have said each of these texts.
  testing::Ended attack(const testing::PrivateSharedMemory& memory,
                        const std::vector<std::string>& verb, int code,
                        const std::vector<std::string>& said,
                        const testing::Confinement& who = {}) {
    const testing::Ended ended = memory.run(verb, who);
    judge(ended, verb.front(), code, said);
    return ended;
  }

  /// The same, and it must leave the files as they are.
  testing::Ended attack_in_vain(const testing::PrivateSharedMemory& memory,
                                const std::vector<std::string>& verb, int code,
                                const std::vector<std::string>& said,
                                const testing::Confinement& who = {}) {
    const Listing before = memory.listing();
    const testing::Ended ended = attack(memory, verb, code, said, who);
    const Listing after = memory.listing();
    EXPECT_EQ(after, before) << verb.front() << " said " << ended.err;
    if (after != before) ++changed_;
    return ended;
  }

  void judge(const testing::Ended& ended, const std::string& what, int code,
             const std::vector<std::string>& said) {
    ++attacks_;
    EXPECT_EQ(ended.signal, 0) << what << " was killed";
    EXPECT_EQ(ended.code, code) << what << " said " << ended.err << ended.out;
    if (ended.signal != 0) ++killed_;
    bool clear = ended.code == code;
    for (const std::string& text : said) {
      const bool found = (ended.err + ended.out).find(text) != std::string::npos;
      EXPECT_TRUE(found) << what << " did not say '" << text << "' but " << ended.err << ended.out;
      clear = clear && found;
    }
    if (!clear) ++unclear_;
  }

  testing::TestFolder folder_;
  std::string file_;

 private:
  int attacks_ = 0;
  int unclear_ = 0;
  int killed_ = 0;
  int changed_ = 0;
};

}  // namespace splinecast::apps
