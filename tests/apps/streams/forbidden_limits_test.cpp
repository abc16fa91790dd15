#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <string>
#include <vector>

#include "tests/apps/streams/forbidden.hpp"

/// Full shared memory and limits of the process: each one gives a clear error and leaves no file,
/// or gives a warning about a degraded function.
namespace splinecast::apps {
namespace {

using testing::Confinement;
using testing::Ended;
using testing::PrivateSharedMemory;
using testing::Process;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;  // mlock does nothing, and any address-space limit is too small
#else
constexpr bool kSanitized = false;
#endif

class ForbiddenLimits : public Forbidden {};

/// Fills a file system except for `left` bytes.
void fill(const PrivateSharedMemory& memory, std::uint64_t left) {
  const auto space = std::filesystem::space(memory.folder());
  const int file = open(memory.file("filler").c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
  ASSERT_EQ(posix_fallocate(file, 0, static_cast<off_t>(space.available - left)), 0);
  close(file);
}

TEST_F(ForbiddenLimits, FullSharedMemoryIsRefusedWithNeededAndFreeBytes) {
  const PrivateSharedMemory memory("8m");
  fill(memory, 4096);
  const std::vector<std::string> ring{"cannot reserve 81920 bytes", "4096 are free"};
  attack_without_effect(memory, replay(), 1, ring);
  attack_without_effect(memory, replay({"--embedded"}), 1, ring);
  attack_without_effect(memory, {"demo", "--seconds", "0.2"}, 1,
                        {"cannot reserve", "4096 are free"});
  attack_without_effect(memory, {"sample", "a", "--rate", "10", "--count", "2", "--wait", "0"}, 4,
                        {"no stream 'a'"});
  attack_without_effect(memory, {"info", "a"}, 4, {"no stream 'a'"});
  attack_without_effect(memory, {"ls"}, 0, {"STREAM"});
}

TEST_F(ForbiddenLimits, RoomForTheRingAloneLeavesNoRing) {
  const PrivateSharedMemory memory("8m");
  fill(memory, 256 << 10U);
  attack_without_effect(memory, replay({"--embedded"}), 1,
                        {"cannot reserve 2207744 bytes", "are free"});
  const auto before = memory.listing();
  Process solver = memory.start({"solve", "a"}, {});
  solver.await_message("waiting for a producer");
  attack(memory, replay({}, "5"), 4, {"no solver for stream 'a'"});
  judge(solver.wait(), "solve", 1, {"cannot reserve 2207744 bytes", "are free"});
  EXPECT_EQ(memory.listing(), before);
}

TEST_F(ForbiddenLimits, AStreamCanBeReadAndRemovedInFullSharedMemory) {
  const PrivateSharedMemory memory("8m");
  ASSERT_EQ(memory.run(replay({"--embedded"}), {}).code, 0);
  fill(memory, 0);
  attack_without_effect(memory, {"sample", "a", "--rate", "10", "--count", "2"}, 0, {"settled"});
  attack_without_effect(memory, {"info", "a"}, 0, {"finished"});
  attack(memory, {"rm", "a"}, 0, {});
  EXPECT_EQ(memory.listing().size(), 1U);
}

TEST_F(ForbiddenLimits, ARegionWithHolesIsRefusedIfNoMemoryIsFree) {
  const PrivateSharedMemory memory("8m");
  ASSERT_EQ(memory.run(replay({"--embedded"}), {}).code, 0);
  const int board = open(memory.file("splinecast.a.spline").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(fallocate(board, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 1 << 20U, 64 << 10U), 0);
  close(board);
  fill(memory, 0);
  const std::vector<std::string> said{"cannot populate 2207744 bytes", "0 are free"};
  attack_without_effect(memory, {"sample", "a", "--rate", "10", "--count", "2"}, 1, said);
  attack_without_effect(memory, {"info", "a"}, 1, said);
  attack_without_effect(memory, {"solve", "a"}, 1, said);
  attack_without_effect(memory, {"rm", "a"}, 1, said);  // it could not notify the readers
}

TEST_F(ForbiddenLimits, LittleLockableMemoryGivesOnlyAWarning) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer's mlock does nothing";
  const Confinement little{.limits = {"--memlock=65536"}};
  const PrivateSharedMemory memory("8m");
  Process solver = memory.start({"solve", "a"}, little);
  attack(memory, replay({}, "60"), 0, {"4 interpolated", "not locked into memory (RLIMIT_MEMLOCK)"},
         little);
  solver.await_message("pages are not locked into memory (RLIMIT_MEMLOCK)");
  solver.signal(SIGTERM);  // a running solver would change its region when it sleeps
  EXPECT_EQ(solver.wait().code, 0);
  attack_without_effect(memory, {"sample", "a", "--rate", "10", "--count", "2"}, 0, {"settled"},
                        little);
}

TEST_F(ForbiddenLimits, AFileSizeLimitGivesAnErrorAndKillsNoProcess) {
  const Confinement little{.limits = {"--fsize=65536"}};
  const PrivateSharedMemory memory("8m");
  const std::string limit = "65536 (RLIMIT_FSIZE)";
  attack_without_effect(memory, replay(), 1, {"cannot reserve 81920 bytes", limit}, little);
  attack_without_effect(memory, replay({"--embedded"}), 1, {"cannot reserve 81920 bytes", limit},
                        little);
  attack_without_effect(memory, {"demo", "--seconds", "0.2"}, 1, {limit}, little);
  ASSERT_EQ(memory.run(replay({"--embedded"}), {}).code, 0);
  attack_without_effect(memory, {"sample", "a", "--rate", "10", "--count", "2"}, 0, {"settled"},
                        little);
  // The limit also applies to output files; /tmp is not part of the namespace.
  const std::string out = folder_.write("out.csv", "");
  std::filesystem::permissions(out, std::filesystem::perms(0666));
  attack_without_effect(memory, {"sample", "a", "--rate", "10000", "--count", "2000", "-o", out}, 1,
                        {"out.csv", "File too large"}, little);
}

TEST_F(ForbiddenLimits, ExhaustedDescriptorsGiveAClearError) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer needs descriptors of its own";
  const PrivateSharedMemory memory("8m");
  int refused = 0;
  for (int descriptors = 4; descriptors < 12; ++descriptors) {
    const Confinement few{.limits = {"--nofile=" + std::to_string(descriptors)}};
    const auto before = memory.listing();
    const Ended ended = memory.run(replay({"--embedded"}), few);
    if (ended.code == 0) {
      judge(ended, "replay", 0, {"4 interpolated"});
      ASSERT_EQ(memory.run({"rm", "a"}, {}).code, 0);
      continue;
    }
    ++refused;
    judge(ended, "replay", 1, {"Too many open files"});
    EXPECT_EQ(memory.listing(), before) << descriptors << " descriptors: " << ended.err;
  }
  EXPECT_GT(refused, 0);
  ASSERT_EQ(memory.run(replay({"--embedded"}), {}).code, 0);
  const Confinement four{.limits = {"--nofile=4"}};
  for (const std::vector<std::string>& verb : std::vector<std::vector<std::string>>{
           {"sample", "a", "--rate", "10", "--count", "2"}, {"solve", "a"}, {"rm", "a"}}) {
    attack_without_effect(memory, verb, 1, {"Too many open files"}, four);
  }
  attack_without_effect(memory, {"info", "a"}, 0, {"finished"}, four);  // opens one file at a time
}

TEST_F(ForbiddenLimits, ExhaustedAddressSpaceGivesAnErrorWithTheNeededBytes) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer needs all of the address space";
  const PrivateSharedMemory memory("128m");
  Process solver =
      memory.start({"solve", "a", "--capacity", "65536"}, {.limits = {"--as=20000000"}});
  solver.await_message("waiting for a producer");
  attack(memory, replay({}, "5"), 4, {"no solver for stream 'a'"});
  judge(solver.wait(), "solve", 1, {"cannot map", "bytes of shared memory"});
  EXPECT_TRUE(memory.listing().empty());
}

TEST_F(ForbiddenLimits, AnotherTimeNamespacesClockIsRefusedForLiveStreams) {
  REQUIRE_ROOT();
  const PrivateSharedMemory memory("8m");
  const Confinement elsewhere{
      .wrapper = {"unshare", "--time", "--monotonic", "1000", "--fork", "--kill-child"}};
  const testing::Confinement here;
  if (Process("/usr/bin/unshare", {"--time", "true"}).wait().code != 0) {
    GTEST_SKIP() << "needs a kernel with time namespaces";
  }
  const std::vector<std::string> live{"replay",     file_,    "--stream", "a",
                                      "--embedded", "--lead", "2000"};
  ASSERT_EQ(memory.run(live, here).code, 0);
  const std::vector<std::string> said{"stream 'a' runs on the clock of time namespace"};
  attack_without_effect(memory, {"sample", "a", "--rate", "10", "--count", "2"}, 1, said,
                        elsewhere);
  attack_without_effect(memory, {"solve", "a"}, 1, said, elsewhere);
  attack_without_effect(memory, {"doctor", "a"}, 1, said, elsewhere);
  attack_without_effect(memory, {"info", "a"}, 0, {"finished"}, elsewhere);
  // A recorded stream uses no clock.
  ASSERT_EQ(memory.run({"rm", "a"}, here).code, 0);
  ASSERT_EQ(memory.run(replay({"--embedded"}), here).code, 0);
  attack_without_effect(memory, {"sample", "a", "--rate", "10", "--count", "2"}, 0, {"settled"},
                        elsewhere);
}

}  // namespace
}  // namespace splinecast::apps
