#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <thread>

#include "ipc/mapping/owner_lock.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/separation.hpp"
#include "ipc/roles/inspect.hpp"
#include "ipc/roles/internals.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/fixtures/processes/few_descriptors.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace {

/// Simulates posix_fallocate on kernels where any signal interrupts it: a piece longer than
/// `longest_whole` bytes never completes, a shorter one completes after `of_each` interruptions.
struct Interruptions {
  std::size_t longest_whole = std::numeric_limits<std::size_t>::max();
  int of_each = 0;
  int tries = 0;
};
Interruptions interruptions;

}  // namespace

/// Replaces the function of the C library.
extern "C" int posix_fallocate(int descriptor, off_t offset, off_t length) {
  const bool is_whole = static_cast<std::size_t>(length) <= interruptions.longest_whole &&
                        interruptions.tries++ >= interruptions.of_each;
  if (!is_whole) return EINTR;
  interruptions.tries = 0;
  return fallocate(descriptor, 0, offset, length) == 0 ? 0 : errno;
}

/// What other processes of the machine may do to a stream's files.
namespace splinecast::ipc {
namespace {

using testing::FewDescriptors;
using testing::TestStream;

constexpr ProducerOptions kRecorded{
    .dimensions = 1, .clock = StreamClock::recorded, .capacity = 64};

Solver solve(const std::string& stream) {
  Solver solver(stream, {.capacity = 64});
  EXPECT_TRUE(solver.attach());
  return solver;
}

/// A read-only open file description of a region, as a reader has one.
class OpenFile {
 public:
  explicit OpenFile(const std::string& path) : descriptor_(open(path.c_str(), O_RDONLY)) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { close(descriptor_); }
  [[nodiscard]] int get() const { return descriptor_; }
  [[nodiscard]] bool lock(short type) const {
    struct flock whole {};
    whole.l_type = type;
    return fcntl(descriptor_, F_OFD_SETLK, &whole) == 0;
  }

 private:
  int descriptor_;
};

/// A write lease on a file: a process that opens the file waits up to 45 s until the holder
/// releases the lease. This holder releases it on the first request (SIGIO).
class Lease {
 public:
  explicit Lease(const std::string& path) {
    struct sigaction action {};
    action.sa_handler = [](int) { fcntl(held, F_SETLEASE, F_UNLCK); };
    action.sa_flags = SA_RESTART;
    sigaction(SIGIO, &action, &before_);
    held = open(path.c_str(), O_RDWR);
    is_held_ = fcntl(held, F_SETLEASE, F_WRLCK) == 0;
  }
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;
  ~Lease() {
    close(held);
    sigaction(SIGIO, &before_, nullptr);
  }
  [[nodiscard]] bool is_held() const { return is_held_; }

 private:
  static inline int held = -1;
  struct sigaction before_ {};
  bool is_held_ = false;
};

TEST(HostileNeighbour, OpeningARegionDoesNotWaitForALease) {
  const TestStream stream;
  const Region region = Region::create(4 * kPage, {});
  ASSERT_TRUE(region.link(stream.name(), RegionKind::waypoints));
  // A lease needs a regular file that no process has open.
  const std::string path = region_path(stream.name(), RegionKind::spline);
  close(open(path.c_str(), O_CREAT | O_RDWR, 0600));
  const auto refused = [&](const auto& look) {
    const Lease lease(path);
    if (!lease.is_held()) return false;
    try {
      look();
    } catch (const BadRegion& error) {
      return std::string(error.what()).find("temporarily unavailable") != std::string::npos;
    }
    return false;
  };
  const std::string& name = stream.name();
  EXPECT_TRUE(refused([&] { (void)Region::open(name, RegionKind::spline, false); }));
  EXPECT_TRUE(refused([&] { (void)Region::open(name, RegionKind::spline, true); }));
  EXPECT_TRUE(refused([&] { (void)peek_header(name, RegionKind::spline, {}); }));
  unlink(path.c_str());
  const std::string lock = lock_path(name, RegionKind::spline);
  close(open(lock.c_str(), O_CREAT | O_RDWR, 0600));
  const Lease lease(lock);
  ASSERT_TRUE(lease.is_held());
  EXPECT_THROW(OwnerLock(name, RegionKind::spline), BadRegion);
}

/// Opens each FIFO for both directions, which ends the wait of a thread that opens it for one.
void free_openers(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) close(open(path.c_str(), O_RDWR | O_NONBLOCK));
}

TEST(HostileNeighbour, AFifoThatReplacesARegionDuringItsOpeningBlocksNoProcess) {
  const TestStream stream;
  const Region region = Region::create(4 * kPage, {});
  ASSERT_TRUE(region.link(stream.name(), RegionKind::spline));
  const std::string path = region_path(stream.name(), RegionKind::spline);
  const std::string other = path + ".exchanged";
  ASSERT_EQ(mkfifo(other.c_str(), 0600), 0);
  std::atomic<bool> done = false;
  std::thread exchanger([&] {
    while (!done) renameat2(AT_FDCWD, path.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE);
  });
  // Ends the wait of a thread that hangs in `open`, and sets `hung`.
  std::atomic<int> looks = 0;
  std::atomic<bool> hung = false;
  std::thread watchdog([&] {
    for (int before = -1, asleep = 0; !done && !hung; before = looks) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      asleep = looks == before && testing::sleeps(getpid()) ? asleep + 1 : 0;
      hung = !done && asleep >= 20;
    }
    while (!done) free_openers({other, path});
  });
  int regular = 0, refused = 0;
  for (; !hung && looks < 1'000'000 && (looks < 20'000 || regular == 0 || refused == 0); ++looks) {
    try {
      (void)peek_header(stream.name(), RegionKind::spline, {});
      ++regular;
    } catch (const BadRegion&) {
      ++refused;
    }
  }
  done = true;
  exchanger.join();
  watchdog.join();
  EXPECT_FALSE(hung) << "after " << looks << " attempts";
  EXPECT_GT(regular, 0);
  EXPECT_GT(refused, 0);
  unlink(path.c_str());
  unlink(other.c_str());
}

TEST(HostileNeighbour, AHardLinkToARegionAllowsNoSecondOwner) {
  const TestStream stream;
  const TestStream second;
  const Producer producer(stream.name(), kRecorded);
  const Solver solver = solve(stream.name());
  for (const RegionKind kind : {RegionKind::waypoints, RegionKind::spline}) {
    ASSERT_EQ(
        link(region_path(stream.name(), kind).c_str(), region_path(second.name(), kind).c_str()),
        0);
  }
  EXPECT_THROW(solve(second.name()), StreamBusy);
  EXPECT_THROW(Producer(second.name(), kRecorded), StreamBusy);
  EXPECT_THROW(remove_stream(second.name(), {}), StreamBusy);
  for (const RegionKind kind : {RegionKind::waypoints, RegionKind::spline}) {
    unlink_region(second.name(), kind);
  }
}

TEST(HostileNeighbour, AReadLockDoesNotHideANewOwnerFromProcessesThatCannotOpenItsLock) {
  const TestStream stream;
  const Producer producer(stream.name(), kRecorded);
  { const Solver dead = solve(stream.name()); }
  const std::string path = region_path(stream.name(), RegionKind::spline);
  const OpenFile observer(path);
  EXPECT_FALSE(region_owner_lives(observer.get()));
  const OpenFile hostile(path);
  ASSERT_TRUE(hostile.lock(F_RDLCK));
  Solver next = solve(stream.name());
  EXPECT_TRUE(next.took_over());
  EXPECT_FALSE(is_region_locked(observer.get()));
  EXPECT_TRUE(region_owner_lives(observer.get()));
  EXPECT_FALSE(Internals::hold_region(next));
  ASSERT_TRUE(hostile.lock(F_UNLCK));
  next.wait(Time(0));
  EXPECT_TRUE(is_region_locked(observer.get()));
  EXPECT_FALSE(hostile.lock(F_RDLCK));
}

TEST(HostileNeighbour, ADeadOwnerIsDetectedUnderAReadLock) {
  const TestStream stream;
  const Producer producer(stream.name(), kRecorded);
  { const Solver dead = solve(stream.name()); }
  const std::string path = region_path(stream.name(), RegionKind::spline);
  const OpenFile hostile(path);
  ASSERT_TRUE(hostile.lock(F_RDLCK));
  const OpenFile observer(path);
  const pid_t owner = fork();
  if (owner == 0) {
    const Solver solver = solve(stream.name());
    raise(SIGSTOP);
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(owner, &status, WUNTRACED), owner);
  ASSERT_TRUE(WIFSTOPPED(status));
  EXPECT_TRUE(region_owner_lives(observer.get()));
  kill(owner, SIGKILL);
  // The dead process is a zombie until its parent waits for it: its id still exists.
  EXPECT_TRUE(testing::await([&] { return !region_owner_lives(observer.get()); }));
  waitpid(owner, &status, 0);
  EXPECT_FALSE(region_owner_lives(observer.get()));
}

TEST(HostileNeighbour, WithoutFreeDescriptorsNoWriterIsReportedDead) {
  const TestStream stream;
  const Producer producer(stream.name(), kRecorded);
  const Solver solver = solve(stream.name());
  const Reader reader(stream.name(), Time(0));
  const FewDescriptors none(0);
  for (const RegionKind kind : {RegionKind::waypoints, RegionKind::spline}) {
    EXPECT_THROW((void)is_owned(stream.name(), kind), OutOfResources);
    EXPECT_THROW((void)owner_lives(stream.name(), kind), OutOfResources);
    EXPECT_THROW(OwnerLock(stream.name(), kind), OutOfResources);
  }
  EXPECT_THROW((void)inspect(stream.name(), {}), OutOfResources);
  EXPECT_TRUE(reader.alive().producer);
  EXPECT_TRUE(reader.alive().solver);
  EXPECT_TRUE(producer.solver_alive());
}

TEST(HostileNeighbour, FrequentSignalsDoNotPreventReservingPages) {
  constexpr std::size_t kBytes = 100 * kPage;
  {
    const Interruptions few{.longest_whole = 2 * kPage, .of_each = 3};
    interruptions = few;
    const Region region = Region::create(kBytes, {});
    EXPECT_EQ(region.bytes().size(), kBytes);
    struct stat status {};
    ASSERT_EQ(fstat(region.descriptor(), &status), 0);
    EXPECT_GE(static_cast<std::size_t>(status.st_blocks) * 512, kBytes);
  }
  interruptions = {.longest_whole = 0, .of_each = std::numeric_limits<int>::max()};
  EXPECT_THROW((void)Region::create(kBytes, {}), BadRegion);
  interruptions = {};
}

/// Whether this process has a file open; compares inodes.
bool has_open(const struct stat& file) {
  constexpr int kDescriptors = 256;
  for (int descriptor = 0; descriptor < kDescriptors; ++descriptor) {
    struct stat status {};
    if (fstat(descriptor, &status) == 0 && status.st_dev == file.st_dev &&
        status.st_ino == file.st_ino) {
      return true;
    }
  }
  return false;
}

TEST(HostileNeighbour, AForkDuringTheOpeningOfALockLeavesTheChildNoDescriptor) {
  const TestStream stream;
  const std::string path = lock_path(stream.name(), RegionKind::spline);
  close(open(path.c_str(), O_CREAT | O_RDWR, 0600));
  struct stat file {};
  ASSERT_EQ(stat(path.c_str(), &file), 0);
  std::atomic<bool> done = false;
  std::thread owner([&] {
    while (!done) (void)OwnedDescriptor::open(path, O_RDWR);
  });
  int kept = 0;
  for (int forks = 0; forks < 200; ++forks) {
    const pid_t child = fork();
    if (child == 0) _exit(has_open(file) ? 1 : 0);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    kept += WEXITSTATUS(status);
  }
  done = true;
  owner.join();
  EXPECT_EQ(kept, 0);
}

}  // namespace
}  // namespace splinecast::ipc
