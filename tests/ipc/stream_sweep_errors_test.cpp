#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "splinecast/ipc/layout.hpp"
#include "splinecast/ipc/owner_lock.hpp"
#include "splinecast/ipc/region.hpp"
#include "splinecast/ipc/segment_board.hpp"
#include "support/few_descriptors.hpp"
#include "told.hpp"

/// What goes wrong with one stream of a sweep, and what somebody else does to it: the others go on.
namespace splinecast::ipc {
namespace {

using core::Time;
using testing::append_at;
using testing::FewDescriptors;
using testing::make_producer;
using testing::TestStream;
using testing::Told;

/// A clock whose time passes between sweeps.
struct SteppedClock final : Clock {
  [[nodiscard]] Time now() const noexcept override { return time; }
  Time time{};
};

/// Sweeps, with time for a look around each time. Returns whether the condition came to hold.
template <typename Condition>
bool sweep_until(StreamSweep& sweep, const Condition& holds) {
  constexpr int kSweeps = 500;
  static SteppedClock clock;
  for (int i = 0; i < kSweeps && !holds(); ++i) {
    sweep.sweep(clock);
    clock.time += std::chrono::milliseconds(50);
  }
  return holds();
}

bool await_news(Told& told, SweepNews news, const std::string& stream) {
  return sweep_until(told.sweep, [&] { return told.count(news, stream) > 0; });
}

/// A file in the folder of shared memory, removed at the end.
class ForeignFile {
 public:
  explicit ForeignFile(const std::string& name) : path_(kSharedMemoryFolder) {
    path_ += name;
    std::ofstream(path_).flush();
  }
  ForeignFile(const ForeignFile&) = delete;
  ForeignFile& operator=(const ForeignFile&) = delete;
  ~ForeignFile() { std::filesystem::remove(path_); }

 private:
  std::string path_;
};

TEST(StreamSweepErrors, FilesUnderNamesThatAreNoStreamsEndNoSweep) {
  const TestStream family;
  const std::string stream = family.name() + ".x";
  const TestStream awaited;
  const std::string begin = "splinecast." + family.name();
  const ForeignFile with_space(begin + " bad.waypoints");
  const ForeignFile with_escape(begin + "\033[2J\n.waypoints");
  const ForeignFile with_dot("splinecast.." + family.name() + ".spline");
  const ForeignFile too_long(begin + std::string(140, 'x') + ".waypoints.lock");
  Told told({family.name() + "*", awaited.name()});
  EXPECT_FALSE(await_news(told, SweepNews::given_up, family.name() + " bad"));
  Producer of_pattern = make_producer(stream);
  Producer named = make_producer(awaited.name());
  EXPECT_TRUE(await_news(told, SweepNews::solving, stream));
  EXPECT_TRUE(await_news(told, SweepNews::solving, awaited.name()));
  of_pattern.withdraw();
  EXPECT_TRUE(await_news(told, SweepNews::gone, stream));
  unlink_region(stream, RegionKind::spline);
  OwnerLock(stream, RegionKind::spline).remove_file();
}

}  // namespace
}  // namespace splinecast::ipc
