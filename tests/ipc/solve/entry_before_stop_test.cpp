#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "ipc/sampling/sampler.hpp"
#include "ipc/verification/settled_segments.hpp"
#include "ipc/verification/verify.hpp"
#include "splinecast/state.hpp"
#include "tests/fixtures/curves/method_trial.hpp"
#include "tests/fixtures/streams/item_record.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// Few waypoints between two stops of a recorded stream.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;

constexpr Time kInterval = milliseconds(10);
constexpr Time kGap = milliseconds(2000);
constexpr Condition kHalt{.kind = ConditionKind::halt, .value = {}};

/// When the solver works, and whether it is replaced each time.
enum class Steps { rarely, after_each_item, as_new_solvers };

/// A recorded stream of three groups of waypoints with gaps between them, at which it stops. The
/// second group has `few` waypoints.
class Groups {
 public:
  Groups(const core::WindowOptions& how, std::size_t few, Steps steps)
      : how_(how), steps_(steps), stream_(1, how), items_(1), settled_(stream_.board.reader) {
    send_group(20);
    send_group(few);
    send_group(20);
    while (finish_one() == AppendStatus::full) drain();
    drain();
  }

  [[nodiscard]] const Summary& summary() const { return stream_.solver.summary(); }
  [[nodiscard]] std::span<const SegmentCopy> segments() const { return settled_.segments(); }

  [[nodiscard]] Verification verify() const {
    return ipc::verify({.window = how_,
                        .kinds = {},
                        .items = items_.items(),
                        .segments = settled_.segments(),
                        .summary = settled_.summary(),
                        .end = kHalt});
  }

  /// The largest distance between the curve and the waypoints of the second group.
  [[nodiscard]] double distance_to_few() const {
    Sampler sampler(stream_.board.reader, StreamClock::recorded);
    State state(1);
    double most = 0;
    for (const Time t : few_) {
      EXPECT_TRUE(has_values(sampler.sample(t, state.ref())));
      most = std::max(most, std::abs(state.position()[0] - position(t)));
    }
    return most;
  }

 private:
  static double position(Time t) { return std::sin(3 * to_seconds(t)); }

  void send_group(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const double x = position(next_);
      const Waypoint waypoint{.time = next_, .position = {&x, 1}};
      const bool begins = i == 0 && next_ > Time::zero();
      while ((begins ? replace(next_ - milliseconds(500), {&waypoint, 1})
                     : stream_.append(waypoint)) == AppendStatus::full) {
        drain();
      }
      work();
      if (groups_ == 1) few_.push_back(next_);
      last_ = next_;
      next_ += kInterval;
    }
    ++groups_;
    if (groups_ == 3) return;
    while (replace(last_, {}) == AppendStatus::full) drain();
    work();
    next_ = last_ + kGap;
  }
  AppendStatus replace(Time t, std::span<const Waypoint> waypoints) {
    return stream_.ring.writer.replace_from(t, waypoints, {stream_.board.reader.consumed()});
  }
  AppendStatus finish_one() {
    return stream_.ring.writer.finish(kHalt, {stream_.board.reader.consumed()});
  }
  void work() {
    if (steps_ == Steps::rarely) return;
    drain();
    if (steps_ == Steps::as_new_solvers) stream_.replace_solver();
  }
  void drain() {
    items_.note_items(stream_.ring.reader);
    stream_.drain();
    settled_.look();
  }

  core::WindowOptions how_;
  Steps steps_;
  testing::MemoryStream stream_;
  testing::ItemRecord items_;
  SettledSegments settled_;
  Time next_{};
  Time last_{};
  int groups_ = 0;
  std::vector<Time> few_;
};

std::vector<double> coefficients_of(const Groups& groups) {
  std::vector<double> all;
  for (const SegmentCopy& segment : groups.segments()) {
    all.insert(all.end(), segment.coefficients.begin(), segment.coefficients.end());
  }
  return all;
}

TEST(EntryBeforeStop, MeetsFewWaypointsBetweenTwoStopsForEverySettleLag) {
  for (const char* const name : {"c2", "akima", "pchip"}) {
    core::WindowOptions how = testing::plain_window(*find_method(name));
    for (how.settle = how.interpolant.method->look_ahead; how.settle <= 10; ++how.settle) {
      for (std::size_t few = 2; few <= how.settle + 2; ++few) {
        const std::string where = name + (", K " + std::to_string(how.settle)) + ", " +
                                  std::to_string(few) + " waypoints";
        const Groups groups(how, few, Steps::after_each_item);
        EXPECT_EQ(groups.summary().passed_over, 0U) << where;
        EXPECT_EQ(groups.summary().interpolated(), 40 + few) << where;
        EXPECT_LT(groups.distance_to_few(), 1e-12) << where;
        const Verification found = groups.verify();
        EXPECT_FALSE(found.first) << where << ": " << found.first->what;
        EXPECT_EQ(found.equal, groups.segments().size()) << where;
        for (const Steps steps : {Steps::rarely, Steps::as_new_solvers}) {
          EXPECT_EQ(coefficients_of(Groups(how, few, steps)), coefficients_of(groups)) << where;
        }
        if (::testing::Test::HasFailure()) return;
      }
    }
  }
}

TEST(EntryBeforeStop, PassesASingleWaypointOver) {
  const Groups groups(core::WindowOptions{}, 1, Steps::after_each_item);
  EXPECT_EQ(groups.summary().passed_over, 1U);
  EXPECT_FALSE(groups.verify().first);
}

}  // namespace
}  // namespace splinecast::ipc
