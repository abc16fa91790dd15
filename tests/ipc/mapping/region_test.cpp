#include "ipc/mapping/region.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/separation.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/streams.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::ipc {
namespace {

using testing::TestStream;

constexpr std::size_t kSize = 4 * kPage;

TEST(Region, HasNoNameUntilItIsLinkedAndReplacesNothing) {
  const TestStream stream;
  const Region region = Region::create(kSize, {});
  EXPECT_FALSE(region_exists(stream.name(), RegionKind::waypoints));
  EXPECT_FALSE(region.is_linked(stream.name(), RegionKind::waypoints));
  ASSERT_TRUE(region.link(stream.name(), RegionKind::waypoints));
  EXPECT_TRUE(region.is_linked(stream.name(), RegionKind::waypoints));
  const Region second = Region::create(kSize, {});
  EXPECT_FALSE(second.link(stream.name(), RegionKind::waypoints));
  EXPECT_FALSE(second.is_linked(stream.name(), RegionKind::waypoints));
}

TEST(Region, HasReservedPagesAndTheRequestedMode) {
  const TestStream stream;
  const mode_t before = umask(077);
  const Region region = Region::create(kSize, {.mode = 0640});
  umask(before);
  ASSERT_TRUE(region.link(stream.name(), RegionKind::spline));
  struct stat status {};
  ASSERT_EQ(stat(region_path(stream.name(), RegionKind::spline).c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0640U);
  EXPECT_EQ(static_cast<std::size_t>(status.st_size), kSize);
  EXPECT_GE(static_cast<std::size_t>(status.st_blocks) * 512, kSize);
}

TEST(Region, LargerThanSharedMemoryIsRefusedWithNeededAndFreeBytes) {
  try {
    (void)Region::create(std::size_t{1} << 50U, {});
    FAIL();
  } catch (const BadRegion& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("1125899906842624 bytes"), std::string::npos) << text;
    EXPECT_NE(text.find("are free"), std::string::npos) << text;
  }
}

TEST(Region, WritableByOthersIsNotTrusted) {
  const TestStream stream;
  const Region region = Region::create(kSize, {});
  ASSERT_TRUE(region.link(stream.name(), RegionKind::waypoints));
  EXPECT_NO_THROW((void)Region::open(stream.name(), RegionKind::waypoints, false));
  for (const mode_t mode : {0620U, 0602U, 0666U}) {
    ASSERT_EQ(fchmod(region.descriptor(), mode), 0);
    EXPECT_THROW((void)Region::open(stream.name(), RegionKind::waypoints, false), BadRegion);
  }
  ASSERT_EQ(fchmod(region.descriptor(), 0600), 0);
}

TEST(Region, OfAnotherUserIsTrustedOnlyIfThatUserIsNamed) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a region away";
  const TestStream stream;
  const Region region = Region::create(kSize, {});
  ASSERT_TRUE(region.link(stream.name(), RegionKind::waypoints));
  ASSERT_EQ(fchown(region.descriptor(), 12345, static_cast<gid_t>(-1)), 0);
  EXPECT_THROW((void)Region::open(stream.name(), RegionKind::waypoints, false), BadRegion);
  EXPECT_NO_THROW(
      (void)Region::open(stream.name(), RegionKind::waypoints, false, {.owner = 12345}));
  ASSERT_EQ(fchown(region.descriptor(), 0, static_cast<gid_t>(-1)), 0);
}

TEST(Region, OpensOnlyRegularFilesAndDoesNotBlock) {
  const TestStream stream;
  const std::string path = region_path(stream.name(), RegionKind::waypoints);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_THROW((void)Region::open(stream.name(), RegionKind::waypoints, false), BadRegion);
  unlink(path.c_str());
  ASSERT_EQ(symlink("/etc/passwd", path.c_str()), 0);
  EXPECT_THROW((void)Region::open(stream.name(), RegionKind::waypoints, false), BadRegion);
  unlink(path.c_str());
  EXPECT_THROW((void)Region::open(stream.name(), RegionKind::waypoints, false), NoSuchStream);
}

TEST(OwnerLock, IsHeldByOneProcessAndFreeAfterItsDeath) {
  const TestStream stream;
  const pid_t child = fork();
  if (child == 0) {
    const OwnerLock lock(stream.name(), RegionKind::spline);
    raise(SIGSTOP);
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, WUNTRACED), child);
  ASSERT_TRUE(WIFSTOPPED(status));
  EXPECT_THROW(OwnerLock(stream.name(), RegionKind::spline), StreamBusy);
  EXPECT_NO_THROW(OwnerLock(stream.name(), RegionKind::waypoints));
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  EXPECT_NO_THROW(OwnerLock(stream.name(), RegionKind::spline));
}

TEST(OwnerLock, IsNotKeptByAForkedChild) {
  const TestStream stream;
  // An owner forks a child and is killed; the child continues to run.
  std::array<int, 2> pipe_ends{};
  ASSERT_EQ(pipe(pipe_ends.data()), 0);
  const pid_t owner = fork();
  if (owner == 0) {
    const OwnerLock lock(stream.name(), RegionKind::spline);
    const Region region = Region::create(kSize, {});
    if (!region.link(stream.name(), RegionKind::spline) ||
        !RegionLock(region.descriptor()).hold()) {
      _exit(1);
    }
    const pid_t child = fork();
    if (child != 0 && write(pipe_ends[1], &child, sizeof child) != sizeof child) _exit(1);
    pause();
    _exit(0);
  }
  pid_t child = -1;
  ASSERT_EQ(read(pipe_ends[0], &child, sizeof child), static_cast<ssize_t>(sizeof child));
  EXPECT_TRUE(owner_lives(stream.name(), RegionKind::spline));
  EXPECT_THROW(OwnerLock(stream.name(), RegionKind::spline), StreamBusy);
  kill(owner, SIGKILL);
  waitpid(owner, nullptr, 0);
  // The lock is free as soon as the child has run its fork handler.
  EXPECT_TRUE(testing::await([&] { return !owner_lives(stream.name(), RegionKind::spline); }));
  EXPECT_TRUE(testing::await([&] {
    try {
      const OwnerLock lock(stream.name(), RegionKind::spline);
      return true;
    } catch (const StreamBusy&) {
      return false;
    }
  }));
  EXPECT_EQ(kill(child, 0), 0);
  kill(child, SIGKILL);
  close(pipe_ends[0]);
  close(pipe_ends[1]);
}

TEST(OwnerLock, IsFreeOnReleaseEvenIfAChildWasJustForked) {
  const TestStream stream;
  pid_t child = -1;
  {
    const OwnerLock lock(stream.name(), RegionKind::spline);
    child = fork();
    if (child == 0) {
      pause();
      _exit(0);
    }
  }
  EXPECT_NO_THROW(OwnerLock(stream.name(), RegionKind::spline));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
}

TEST(OwnerLock, IsNotBlockedByTheLockOfAReader) {
  const TestStream stream;
  const Region region = Region::create(kSize, {});
  ASSERT_TRUE(region.link(stream.name(), RegionKind::spline));
  const int reader = open(region_path(stream.name(), RegionKind::spline).c_str(), O_RDONLY);
  struct flock lock {};
  lock.l_type = F_RDLCK;
  ASSERT_EQ(fcntl(reader, F_OFD_SETLK, &lock), 0);
  EXPECT_FALSE(owner_lives(stream.name(), RegionKind::spline));
  EXPECT_NO_THROW(OwnerLock(stream.name(), RegionKind::spline));
  close(reader);
}

TEST(Names, AreCheckedBeforeTheyBecomePaths) {
  for (const char* name : {"", ".x", "a/b", "a b", "ä"}) {
    EXPECT_THROW(require_stream_name(name), BadRequest) << name;
  }
  EXPECT_THROW(require_stream_name(std::string(129, 'a')), BadRequest);
  EXPECT_NO_THROW(require_stream_name("arm-1.left_hand"));
}

TEST(Names, ThatAreInvalidForStreamsAreNotListed) {
  const TestStream stream;
  const Region region = Region::create(kSize, {});
  ASSERT_TRUE(region.link(stream.name(), RegionKind::spline));
  const std::string begin = std::string(kSharedMemoryFolder) + "splinecast.";
  const std::vector<std::string> invalid{
      begin + stream.name() + " bad.waypoints", begin + stream.name() + "\033[2J\n.spline",
      begin + "." + stream.name() + ".waypoints.lock",
      begin + stream.name() + std::string(130, 'x') + ".spline.lock"};
  for (const std::string& path : invalid) close(open(path.c_str(), O_CREAT | O_RDWR, 0600));
  int listed = 0;
  for (const std::string& name : stream_names()) {
    EXPECT_NO_THROW(require_stream_name(name)) << name;
    listed += name == stream.name() ? 1 : 0;
  }
  EXPECT_EQ(listed, 1);
  for (const std::string& path : invalid) unlink(path.c_str());
}

TEST(Names, ArePrintedWithoutTerminalControlCharacters) {
  EXPECT_EQ(printable("arm-1.left hand \u00e4\u20ac\U0001f916"),
            "arm-1.left hand \u00e4\u20ac\U0001f916");
  EXPECT_EQ(printable("a\033[2J\r\n\t\x7f"), R"(a\x1b[2J\x0d\x0a\x09\x7f)");
  EXPECT_EQ(printable("\xc3"), R"(\xc3)");                                  // truncated
  EXPECT_EQ(printable("\xc3("), R"(\xc3()");                                // no continuation byte
  EXPECT_EQ(printable("\xc0\x80\xe0\x80\x8a"), R"(\xc0\x80\xe0\x80\x8a)");  // overlong encoding
  EXPECT_EQ(printable("\xed\xa0\x80"), R"(\xed\xa0\x80)");                  // surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80\xff"), R"(\xf4\x90\x80\x80\xff)");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            R"(\xc2\x9b)"
            "2J");  // CSI as one C1 control character
  EXPECT_EQ(printable("\u202e\u2028"), R"(\xe2\x80\xae\xe2\x80\xa8)");
  try {
    require_stream_name("a\033[2J");
    FAIL();
  } catch (const BadRequest& error) {
    EXPECT_EQ(std::string(error.what()).find('\033'), std::string::npos);
  }
}

}  // namespace
}  // namespace splinecast::ipc
