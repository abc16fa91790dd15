#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/fixtures/processes/private_shared_memory.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::apps {

/// Obstacles for verbs, in a private /dev/shm. Each attack must end with a clear error or be
/// tolerated, and must leave every file unchanged. The test record contains the counts.
class Forbidden : public ::testing::Test {
 protected:
  using Listing = std::map<std::string, std::string>;

  void SetUp() override {
    REQUIRE_PRIVATE_SHARED_MEMORY();
    // Other users than root must be able to read the folder.
    std::filesystem::permissions(folder_.path(""), std::filesystem::perms(0755));
    file_ = folder_.write("moves.csv", "t,x,y\n0,0,1\n0.1,0.2,1\n0.2,0.6,0.8\n0.3,1,0.5\n");
  }

  void TearDown() override {
    RecordProperty("attacks", attacks_);
    RecordProperty("unclear", unclear_);
    RecordProperty("killed", killed_);
    RecordProperty("changed", changed_);
  }

  /// Arguments of `replay`, which sends the recording and waits `wait` seconds for a solver.
  [[nodiscard]] std::vector<std::string> replay(const std::vector<std::string>& more = {},
                                                const std::string& wait = "0.1") const {
    std::vector<std::string> all{"replay",   file_,    "--stream", "a",      "--clock",
                                 "recorded", "--rate", "max",      "--wait", wait};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  /// One attack: the verb must exit with `code` and print each text of `said`.
  testing::Ended attack(const testing::PrivateSharedMemory& memory,
                        const std::vector<std::string>& verb, int code,
                        const std::vector<std::string>& said,
                        const testing::Confinement& who = {}) {
    const testing::Ended ended = memory.run(verb, who);
    judge(ended, verb.front(), code, said);
    return ended;
  }

  /// Like `attack`, but the verb must leave all files unchanged.
  testing::Ended attack_without_effect(const testing::PrivateSharedMemory& memory,
                                       const std::vector<std::string>& verb, int code,
                                       const std::vector<std::string>& said,
                                       const testing::Confinement& who = {}) {
    const Listing before = memory.listing();
    const testing::Ended ended = attack(memory, verb, code, said, who);
    const Listing after = memory.listing();
    EXPECT_EQ(after, before) << verb.front() << " printed " << ended.err;
    if (after != before) ++changed_;
    return ended;
  }

  void judge(const testing::Ended& ended, const std::string& what, int code,
             const std::vector<std::string>& said) {
    ++attacks_;
    EXPECT_EQ(ended.signal, 0) << what << " was killed";
    EXPECT_EQ(ended.code, code) << what << " printed " << ended.err << ended.out;
    if (ended.signal != 0) ++killed_;
    bool clear = ended.code == code;
    for (const std::string& text : said) {
      const bool found = (ended.err + ended.out).find(text) != std::string::npos;
      EXPECT_TRUE(found) << what << " did not print '" << text << "' but " << ended.err
                         << ended.out;
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
