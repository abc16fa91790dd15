#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <system_error>

#include "ipc/memory/names.hpp"
#include "ipc/memory/region_watch.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/rate_commander.hpp"
#include "splinecast/solver.hpp"
#include "tests/fixtures/processes/process.hpp"

namespace splinecast::ipc {
namespace {

using testing::await;
using testing::TestStream;
using Names = std::set<std::string>;

/// A watch that cannot have an event queue, because the process may open no more files.
std::unique_ptr<RegionWatch> watch_without_events() {
  struct rlimit before {};
  getrlimit(RLIMIT_NOFILE, &before);
  struct rlimit none = before;
  none.rlim_cur = 0;
  setrlimit(RLIMIT_NOFILE, &none);
  auto watch = std::make_unique<RegionWatch>();
  setrlimit(RLIMIT_NOFILE, &before);
  return watch;
}

/// Creates and removes files of other programs in the folder of shared memory.
void make_other_files(const std::string& prefix, int count) {
  for (int i = 0; i < count; ++i) {
    const std::string path = std::string(kSharedMemoryFolder) + prefix + std::to_string(i);
    const int file = open(path.c_str(), O_CREAT | O_CLOEXEC | O_RDONLY, 0600);
    ASSERT_GE(file, 0) << path;
    close(file);
    unlink(path.c_str());
  }
}

class ARegionWatch : public ::testing::TestWithParam<bool> {
 protected:
  TestStream law_;
  TestStream other_;
  std::unique_ptr<RegionWatch> watch_ =
      GetParam() ? std::make_unique<RegionWatch>() : watch_without_events();

  Names names() {
    watch_->poll();
    return watch_->commanders().names_of(law_.name());
  }
  /// Without events a change is noticed at the next look at the folder's time.
  bool become(const Names& expected) {
    if (GetParam()) return names() == expected;
    return await([&] { return names() == expected; });
  }
};

TEST_P(ARegionWatch, KnowsTheNamesThatAreThereComeAndGo) {
  const RateCommander there(law_.name(), "there");
  const RateCommander elsewhere(other_.name(), "elsewhere");
  EXPECT_EQ(names(), (Names{"there"}));
  const Word before = watch_->commanders().version();
  {
    const RateCommander comes(law_.name(), "comes");
    EXPECT_EQ(watch_->commanders().version(), before);
    EXPECT_TRUE(become({"comes", "there"}));
    EXPECT_NE(watch_->commanders().version(), before);
  }
  EXPECT_EQ(names(), (Names{"comes", "there"}));  // its region stays
  unlink(region_path(commander_stream(law_.name(), "comes"), RegionKind::commander).c_str());
  EXPECT_TRUE(become({"there"}));
  EXPECT_EQ(watch_->commanders().names_of(other_.name()), (Names{"elsewhere"}));
}

TEST_P(ARegionWatch, NoticesARegionThatIsReplaced) {
  const std::string path = region_path(commander_stream(law_.name(), "one"), RegionKind::commander);
  (void)RateCommander(law_.name(), "one");
  EXPECT_EQ(names(), (Names{"one"}));
  const Word before = watch_->commanders().version();
  unlink(path.c_str());
  (void)RateCommander(law_.name(), "one");
  EXPECT_TRUE(
      await([&] { return names() == Names{"one"} && watch_->commanders().version() != before; }));
}

/// More files than the kernel keeps events for: the newest events are lost.
TEST_P(ARegionWatch, MissesNoneIfEventsAreLost) {
  EXPECT_EQ(names(), Names{});
  make_other_files(law_.name() + ".other.", 20'000);
  const RateCommander comes(law_.name(), "comes");
  EXPECT_TRUE(await([&] { return names() == Names{"comes"}; }));
}

TEST_P(ARegionWatch, KnowsTheStreamsThatHaveARing) {
  const auto has = [&] {
    watch_->poll();
    return watch_->streams().contains(other_.name());
  };
  EXPECT_FALSE(has());
  const Word before = watch_->version();
  Producer producer(other_.name(), {.dimensions = 1});
  EXPECT_TRUE(await(has));
  EXPECT_NE(watch_->version(), before);
  producer.withdraw();
  EXPECT_TRUE(await([&] { return !has(); }));
}

constexpr const char* kQueue = "anon_inode:inotify";

/// The open descriptors of this process whose link has this text.
std::set<int> descriptors_of(const std::string& text) {
  std::set<int> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code error;
    const std::string link = std::filesystem::read_symlink(entry.path(), error);
    if (link.find(text) != std::string::npos) found.insert(std::stoi(entry.path().filename()));
  }
  return found;
}

/// Replaces each event queue of this process by one that watches nothing.
void make_events_stop() {
  for (const int queue : descriptors_of(kQueue)) {
    const int empty = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    ASSERT_GE(dup2(empty, queue), 0);
    close(empty);
  }
}

/// The kernel closes the descriptors of a killed process from the highest number down, and the end
/// of an event queue can take it seconds on a busy machine. The next owner waits for the locks.
TEST(RegionWatchOfASolver, IsClosedAfterItsLocksWhenItsProcessIsKilled) {
  const TestStream stream;
  Solver solver(stream.name(), {});
  const Producer producer(stream.name(), {.dimensions = 1});
  ASSERT_TRUE(solver.attach());
  const std::set<int> queues = descriptors_of(kQueue);
  const std::set<int> files = descriptors_of(stream.name());
  ASSERT_FALSE(queues.empty());
  ASSERT_GE(files.size(), 2U);  // lock file and region
  EXPECT_GT(*files.begin(), *queues.rbegin());
}

TEST(RegionWatchWithoutEvents, NoticesByTheFoldersTimeThatNoneArrive) {
  const TestStream law;
  RegionWatch watch;
  watch.poll();
  make_events_stop();
  const RateCommander comes(law.name(), "comes");
  EXPECT_TRUE(await([&] {
    watch.poll();
    return watch.commanders().names_of(law.name()).contains("comes");
  }));
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutEvents, ARegionWatch, ::testing::Bool(),
                         [](const auto& tested) { return tested.param ? "events" : "times"; });

}  // namespace
}  // namespace splinecast::ipc
