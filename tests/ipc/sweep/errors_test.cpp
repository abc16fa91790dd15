#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "ipc/layout/check.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/mapping/region.hpp"
#include "tests/fixtures/processes/few_descriptors.hpp"
#include "tests/fixtures/streams/board_words.hpp"
#include "tests/ipc/sweep/recording_sweep.hpp"

/// Errors of one stream of a sweep, and changes by other processes, do not affect other streams.
namespace splinecast::ipc {
namespace {

using testing::append_at;
using testing::FewDescriptors;
using testing::make_producer;
using testing::RecordingSweep;
using testing::TestStream;

/// A clock that advances between sweeps.
struct SteppedClock final : Clock {
  [[nodiscard]] Time now() const noexcept override { return time; }
  Time time{};
};

/// Sweeps at intervals that allow a scan each time. Returns whether the condition became true.
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

bool await_news(RecordingSweep& reported, SweepNews news, const std::string& stream) {
  return sweep_until(reported.sweep, [&] { return reported.count(news, stream) > 0; });
}

/// A file in the shared-memory folder; the destructor removes it.
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

/// Overwrites a velocity of every knot on a board with NaN.
void damage(const std::string& stream) {
  const auto header = peek_header(stream, RegionKind::spline, {});
  ASSERT_TRUE(header);
  const auto layout = checked_board_layout(*header, header->region_bytes);
  const int board = open(region_path(stream, RegionKind::spline).c_str(), O_WRONLY | O_CLOEXEC);
  const double none = std::nan("");
  for (Word number = 0; number < layout.capacity; ++number) {
    for (const std::size_t c : {0U, 1U}) {
      const std::size_t at = testing::cell_offset(layout, number, c) + kCellVelocity * sizeof(Word);
      ASSERT_EQ(pwrite(board, &none, sizeof none, static_cast<off_t>(at)), 8);
    }
  }
  close(board);
}

TEST(StreamSweepErrors, FilesWithInvalidStreamNamesDoNotEndASweep) {
  const TestStream family;
  const std::string stream = family.name() + ".x";
  const TestStream awaited;
  const std::string begin = "splinecast." + family.name();
  const ForeignFile with_space(begin + " bad.waypoints");
  const ForeignFile with_escape(begin + "\033[2J\n.waypoints");
  const ForeignFile with_dot("splinecast.." + family.name() + ".spline");
  const ForeignFile too_long(begin + std::string(140, 'x') + ".waypoints.lock");
  RecordingSweep reported({family.name() + "*", awaited.name()});
  EXPECT_FALSE(await_news(reported, SweepNews::given_up, family.name() + " bad"));
  Producer of_pattern = make_producer(stream);
  Producer named = make_producer(awaited.name());
  EXPECT_TRUE(await_news(reported, SweepNews::solving, stream));
  EXPECT_TRUE(await_news(reported, SweepNews::solving, awaited.name()));
  of_pattern.withdraw();
  EXPECT_TRUE(await_news(reported, SweepNews::gone, stream));
  unlink_region(stream, RegionKind::spline);
  OwnerLock(stream, RegionKind::spline).remove_file();
}

TEST(StreamSweepErrors, AFailedStepGivesUpItsStreamAndTheOthersContinue) {
  const TestStream bad;
  const TestStream good;
  Producer of_bad = make_producer(bad.name());
  Producer of_good = make_producer(good.name());
  RecordingSweep reported({bad.name(), good.name()});
  for (int i = 0; i < 12; ++i) append_at(of_bad, Time(10'000'000) * i);
  ASSERT_TRUE(sweep_until(reported.sweep, [&] { return of_bad.wait_until_consumed(Time(0)); }));
  damage(bad.name());
  ASSERT_EQ(of_bad.replace_from(Time(110'000'000), {}), AppendStatus::accepted);
  ASSERT_TRUE(await_news(reported, SweepNews::given_up, bad.name()));
  EXPECT_NE(reported.why.find("holds data that its solver did not write"), std::string::npos)
      << reported.why;
  EXPECT_FALSE(is_owned(bad.name(), RegionKind::spline));
  append_at(of_good, Time(0));
  EXPECT_TRUE(sweep_until(reported.sweep, [&] { return of_good.wait_until_consumed(Time(0)); }));
  EXPECT_EQ(reported.count(SweepNews::given_up, bad.name()), 1);
}

TEST(StreamSweepErrors, AnExceptionFromTheNewsCallbackLosesNoStream) {
  const TestStream family;
  const std::string first = family.name() + ".1";
  const std::string second = family.name() + ".2";
  Producer of_first = make_producer(first);
  Producer of_second = make_producer(second);
  StreamSweep sweep({family.name() + ".*"}, RecordingSweep::small(),
                    [](auto&&...) { throw std::runtime_error("callback failed"); });
  EXPECT_TRUE(sweep_until(sweep, [&] { return sweep.solved() == 2; }));
  of_first.withdraw();
  of_second.withdraw();
  EXPECT_TRUE(sweep_until(
      sweep, [&] { return sweep.solved() == 0 && !is_owned(second, RegionKind::spline); }));
  for (const std::string& stream : {first, second}) {
    unlink_region(stream, RegionKind::spline);
    OwnerLock(stream, RegionKind::spline).remove_file();
  }
}

TEST(StreamSweepErrors, AGivenUpNamedStreamIsRetriedWhenItIsRecreated) {
  const TestStream bad;
  const TestStream other;
  Producer before = make_producer(bad.name());
  {
    Solver solver(bad.name(), {.settle = 3, .capacity = 64});
    ASSERT_TRUE(solver.attach());
  }
  RecordingSweep reported({bad.name(), other.name()}, {.settle = 4, .capacity = 64});
  ASSERT_TRUE(await_news(reported, SweepNews::given_up, bad.name()));
  before.withdraw();
  unlink_region(bad.name(), RegionKind::spline);
  // The sweep does not scan in between, so it does not see that the name was free.
  Producer after = make_producer(bad.name());
  append_at(after, Time(0));
  EXPECT_TRUE(await_news(reported, SweepNews::solving, bad.name()));
  EXPECT_EQ(reported.count(SweepNews::given_up, bad.name()), 1);
}

/// Sweeps with too few descriptors for two streams, and then with enough.
void expect_postponed(RecordingSweep& reported, rlim_t free,
                      const std::vector<std::string>& streams) {
  const auto count = [&](SweepNews news) {
    return reported.count(news, streams[0]) + reported.count(news, streams[1]);
  };
  const auto await_count = [&](SweepNews news, std::ptrdiff_t count_of_both) {
    return sweep_until(reported.sweep, [&] { return count(news) == count_of_both; });
  };
  {
    const FewDescriptors few(free);
    EXPECT_TRUE(await_count(SweepNews::postponed, 1));
    EXPECT_EQ(count(SweepNews::solving), 1);
    EXPECT_FALSE(await_count(SweepNews::postponed, 2));
  }
  EXPECT_TRUE(await_count(SweepNews::solving, 2));
  EXPECT_EQ(count(SweepNews::postponed), 1);
  EXPECT_EQ(count(SweepNews::given_up), 0);
}

TEST(StreamSweepErrors, ANamedStreamIsRetriedAfterDescriptorsRanOut) {
  const TestStream first;
  const TestStream second;
  RecordingSweep reported({first.name(), second.name()});
  Producer of_first = make_producer(first.name());
  Producer of_second = make_producer(second.name());
  expect_postponed(reported, 1,
                   {first.name(), second.name()});  // the sweep already holds their locks
}

TEST(StreamSweepErrors, AStreamOfAPatternIsRetriedAfterDescriptorsRanOut) {
  const TestStream first;
  const TestStream second;
  RecordingSweep reported({"[" + first.name().substr(0, 1) + "]" + first.name().substr(1),
                           "[" + second.name().substr(0, 1) + "]" + second.name().substr(1)});
  Producer of_first = make_producer(first.name());
  Producer of_second = make_producer(second.name());
  expect_postponed(reported, 2, {first.name(), second.name()});
}

}  // namespace
}  // namespace splinecast::ipc
