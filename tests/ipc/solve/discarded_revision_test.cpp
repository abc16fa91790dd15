#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "ipc/solve/published_curve.hpp"
#include "ipc/verification/settled_segments.hpp"
#include "tests/fixtures/curves/method_trial.hpp"
#include "tests/fixtures/curves/streaming_methods.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// A revision that is discarded, because it is late or because its solver died, does not affect the
/// later results of this solver or of its successor: the curve has the bits of an undisturbed one.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using testing::Trial;

constexpr std::size_t kDimensions = 2;
constexpr std::size_t kFirstKnots = 20;  ///< of the run that a replacement cuts
constexpr std::size_t kKnots = 40;
constexpr Time kTick = milliseconds(10);

/// The clock of a solver that is stopped for 9 hours after its first reading.
class HeldUpClock final : public Clock {
 public:
  explicit HeldUpClock(Time now) : now_(now) {}
  [[nodiscard]] Time now() const noexcept override {
    return looks_++ == 0 ? now_ : now_ + std::chrono::hours(9);
  }

 private:
  Time now_;
  mutable int looks_ = 0;
};

enum class Disturbance { none, missed, missed_and_taken_over };

/// A live stream. With a disturbance, the first revision of each item that would change the curve
/// misses its deadline; all following revisions are in time.
class Stream {
 public:
  Stream(const core::WindowOptions& how, Disturbance disturbance)
      : disturbance_(disturbance),
        stream_(kDimensions, how, 64, 256, {}, {}, LiveOptions{.history = std::chrono::hours(1)}),
        trial_(testing::random_trial(5, kKnots, kDimensions, 4)) {
    Time t = 3 * kTick;
    for (Time& time : trial_.mesh.times) time = t += kTick;
  }

  /// Appends waypoints one by one, replaces the future by a run of `entered` waypoints, appends the
  /// remaining waypoints and finishes. Returns all segments.
  std::vector<SegmentCopy> play(std::size_t entered) {
    const Waypoints waypoints = trial_.waypoints();
    for (std::size_t i = 0; i < kFirstKnots; ++i) append(waypoints[i]);
    std::vector<Waypoint> replacing;
    for (std::size_t i = 0; i < entered; ++i) replacing.push_back(waypoints[kFirstKnots + i]);
    const Time from = trial_.mesh.times[kFirstKnots - 1] - kTick / 2;
    EXPECT_EQ(stream_.ring.writer.replace_from(from, replacing, solved()), AppendStatus::accepted);
    step();
    for (std::size_t i = kFirstKnots + entered; i < kKnots; ++i) append(waypoints[i]);
    EXPECT_EQ(stream_.ring.writer.finish({ConditionKind::own, {}}, solved()),
              AppendStatus::accepted);
    step();
    EXPECT_TRUE(stream_.solver.summary().finished);
    EXPECT_EQ(stream_.solver.summary().refused, 0U);
    EXPECT_EQ(stream_.solver.summary().knots, kKnots);
    // Not every item has a discarded revision: a revision that changes only counters has no
    // deadline.
    if (disturbance_ != Disturbance::none) {
      EXPECT_GT(discarded_, kKnots / 2);
    }
    SettledSegments settled(stream_.board.reader, true);
    settled.look();
    return {settled.segments().begin(), settled.segments().end()};
  }

 private:
  [[nodiscard]] WaypointRingWriter::Solved solved() {
    return {stream_.board.reader.consumed(), stream_.board.reader.look().settled_until,
            &stream_.clock};
  }
  void append(const Waypoint& waypoint) {
    EXPECT_EQ(stream_.ring.writer.append(waypoint, solved()), AppendStatus::accepted);
    step();
    stream_.clock.time += kTick;
  }
  void step() {
    // The clock does not advance here but in `append`, so that the next waypoint is always after
    // the settled time.
    if (disturbance_ != Disturbance::none && misses_one(true)) {
      ++discarded_;
      if (disturbance_ == Disturbance::missed_and_taken_over) stream_.replace_solver();
    }
    EXPECT_FALSE(misses_one(false));
  }
  /// Steps until a revision is discarded or the solver has no work to do at this time. A search for
  /// an entry takes several steps, and some of them publish nothing.
  [[nodiscard]] bool misses_one(bool is_held_up) {
    constexpr int kMostSteps = 100;
    for (int i = 0; i < kMostSteps; ++i) {
      const HeldUpClock late(stream_.clock.time);
      const Clock& clock = stream_.clock;
      if (stream_.solver.step(is_held_up ? static_cast<const Clock&>(late) : clock).missed)
        return true;
      if (stream_.solver.due() > stream_.clock.time) return false;
    }
    ADD_FAILURE() << "too many steps";
    return false;
  }

  Disturbance disturbance_;
  std::size_t discarded_ = 0;
  testing::MemoryStream stream_;
  Trial trial_;
};

void expect_same(const std::vector<SegmentCopy>& got, const std::vector<SegmentCopy>& wanted) {
  ASSERT_EQ(got.size(), wanted.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    ASSERT_EQ(got[i].number, wanted[i].number) << i;
    ASSERT_EQ(got[i].left, wanted[i].left) << i;
    ASSERT_EQ(got[i].right, wanted[i].right) << i;
    ASSERT_EQ(got[i].kind, wanted[i].kind) << i;
    ASSERT_EQ(got[i].coefficients, wanted[i].coefficients) << i;
    ASSERT_EQ(got[i].acceleration_step, wanted[i].acceleration_step) << i;
    ASSERT_EQ(got[i].newer_knots, wanted[i].newer_knots) << i;
    ASSERT_EQ(got[i].origin.item, wanted[i].origin.item) << i;
  }
}

class DiscardedRevision : public ::testing::TestWithParam<const Method*> {
 protected:
  static core::WindowOptions options(std::size_t settle, Tail tail = Tail::bessel) {
    core::WindowOptions how = testing::plain_window(*GetParam());
    how.settle = std::max(settle, GetParam()->converges() ? 0 : GetParam()->look_ahead);
    how.tail = tail;
    how.held_before_start = true;
    return how;
  }
  static void expect_no_trace(const core::WindowOptions& how, std::size_t entered) {
    SCOPED_TRACE(::testing::Message()
                 << "lag " << how.settle << ", tail " << static_cast<int>(how.tail) << ", "
                 << entered << " knots entered");
    const auto wanted = Stream(how, Disturbance::none).play(entered);
    expect_same(Stream(how, Disturbance::missed).play(entered), wanted);
    // Without limits, a solver that takes over may find other ones in the motion.
    core::WindowOptions limited = how;
    limited.limits.acceleration.assign(kDimensions, 1e6);
    expect_same(Stream(limited, Disturbance::missed_and_taken_over).play(entered),
                Stream(limited, Disturbance::none).play(entered));
  }
};

TEST_P(DiscardedRevision, LeavesNoTraceForAnySettleLag) {
  for (const std::size_t settle : {0U, 1U, 2U, 3U, 8U, 64U}) expect_no_trace(options(settle), 3);
}

TEST_P(DiscardedRevision, LeavesNoTraceForAnyTail) {
  for (const Tail tail : {Tail::bessel, Tail::parabolic, Tail::natural, Tail::clamped}) {
    expect_no_trace(options(4, tail), 2);
  }
}

TEST_P(DiscardedRevision, LeavesNoTraceInRunsOfOneToFiveKnots) {
  for (std::size_t entered = 1; entered <= 5; ++entered) {
    for (const std::size_t settle : {0U, 2U, 8U}) expect_no_trace(options(settle), entered);
  }
}

/// A curve and its board, without a solver, so that the discarded revisions can have any content.
class Curve {
 public:
  explicit Curve(const core::WindowOptions& how)
      : how_(how), board_(kDimensions, 64, how.interpolant.method->smooths()) {
    take_over();
  }

  /// Publishes the waypoints [from, to) of a trial in one revision. If `entry` has a value, the
  /// curve is cut there first.
  void publish(const Trial& trial, std::size_t from, std::size_t to, std::optional<Time> entry) {
    change(trial, from, to, entry);
    summary_.changed_from = curve_->write();
    curve_->write_summary(summary_);
    ASSERT_TRUE(board_.writer.is_sound());
    board_.writer.commit(summary_);
    curve_->committed(summary_);
  }
  void finish() {
    // An end that would exceed the limits is searched for in the published curve.
    for (int i = 0; i < 100 && !tries_to_finish(); ++i) publish({}, 0, 0, std::nullopt);
    summary_.finished = true;
    publish({}, 0, 0, std::nullopt);
  }

  /// Like `publish`, optionally with a finish, but the writer or its successor discards it.
  void disturb(const Trial& other, std::size_t from, std::size_t to, std::optional<Time> entry,
               bool finishes, bool takes_over) {
    change(other, from, to, entry);
    if (finishes) (void)tries_to_finish();
    (void)curve_->write();
    if (takes_over) {
      take_over();
    } else {
      board_.writer.discard();
      curve_->restore(summary_);
    }
    ASSERT_FALSE(curve_->is_damaged());
  }

  /// All segments on the board.
  [[nodiscard]] std::vector<SegmentCopy> segments() const {
    std::vector<SegmentCopy> all;
    BoardSegment segment(kDimensions, board_.reader.smooths());
    for (Word n = summary_.first; n <= summary_.newest && n > 0;) {
      const auto taken = segment.take(board_.reader, summary_, n);
      if (taken == BoardSegment::Taken::none && n == summary_.newest) break;
      EXPECT_EQ(taken, BoardSegment::Taken::whole) << n;
      if (taken != BoardSegment::Taken::whole) break;
      segment.copy_to(all.emplace_back());
      n = segment.next();
    }
    return all;
  }

 private:
  void take_over() {
    board_.replace_writer();
    curve_.emplace(board_.writer, board_.reader, how_, DimensionKinds(),
                   EntryOptions{.is_live = true});
    curve_->restore(summary_);
  }
  void change(const Trial& trial, std::size_t from, std::size_t to, std::optional<Time> entry) {
    curve_->freeze(Time::min());
    if (entry) curve_->begin_run(*entry, {});
    for (std::size_t i = from; i < to; ++i) curve_->append(trial.waypoints()[i], i);
    int tries = kTries;
    curve_->advance_search(Time::min(), Time::max(), true, tries);
  }
  [[nodiscard]] bool tries_to_finish() {
    int tries = kTries;
    return curve_->finish({ConditionKind::halt, {}}, Time::min(), Time::max(), tries);
  }

  static constexpr int kTries = 1000;  // enough for any search

  core::WindowOptions how_;
  testing::MemoryBoard board_;
  std::optional<PublishedCurve> curve_;
  Summary summary_;
};

/// A time for a cut: in the interval that ends at waypoint `from` - 1.
Time before_waypoint(const Trial& trial, std::size_t from) {
  return trial.mesh.times[from - 1] - (trial.mesh.times[from - 1] - trial.mesh.times[from - 2]) / 3;
}

/// Different waypoints, each 1 ns after the waypoint of the trial with the same index.
Trial beside(const Trial& trial, std::uint64_t seed) {
  Trial other = testing::random_trial(seed, trial.mesh.size(), kDimensions, 4);
  for (std::size_t i = 0; i < trial.mesh.size(); ++i) {
    other.mesh.times[i] = trial.mesh.times[i] + Time(1);
  }
  return other;
}

/// Discards zero to two revisions of other waypoints, from index `next` on.
void disturb_at_random(Curve& disturbed, const Trial& trial, const Trial& other, std::size_t next,
                       std::mt19937_64& random, bool takes_over) {
  for (int times = static_cast<int>(random() % 3); times > 0; --times) {
    const std::size_t end = std::min<std::size_t>(next + 1 + random() % 4, kKnots);
    const bool enters = next > 3 && random() % 3 == 0;
    disturbed.disturb(other, next, end,
                      enters ? std::optional(before_waypoint(trial, next)) : std::nullopt,
                      random() % 4 == 0, random() % 2 == 0 && takes_over);
  }
}

/// Publishes the same waypoints on two curves, in revisions of one to three waypoints and in runs
/// that begin with one to five waypoints, and finishes. On one curve, revisions of other waypoints
/// are also discarded. A solver that takes over does not know the whole past motion, on which
/// entries depend if there are no limits; so this case has limits.
void expect_no_trace_of_others(core::WindowOptions how, std::uint64_t seed, bool takes_over) {
  if (takes_over) how.limits.acceleration.assign(kDimensions, 100);
  SCOPED_TRACE(::testing::Message() << "lag " << how.settle << ", seed " << seed);
  constexpr std::size_t kMore = 3;  // after the last published one
  const Trial trial = testing::random_trial(seed, kKnots + kMore, kDimensions, 4);
  const Trial other = beside(trial, seed + 1000);
  std::mt19937_64 random(seed);
  Curve disturbed(how);
  Curve undisturbed(how);
  std::size_t since_entry = 0;
  for (std::size_t next = 0; next < kKnots;) {
    std::size_t count = 1 + random() % 3;
    std::optional<Time> entry;
    if (next > 3 && since_entry > random() % 6) {
      entry = before_waypoint(trial, next);
      count = 1 + random() % 5;
      since_entry = 0;
    }
    const std::size_t to = std::min(next + count, kKnots);
    disturb_at_random(disturbed, trial, other, next, random, takes_over);
    disturbed.publish(trial, next, to, entry);
    undisturbed.publish(trial, next, to, entry);
    expect_same(disturbed.segments(), undisturbed.segments());
    if (::testing::Test::HasFatalFailure()) return;
    since_entry += to - next;
    next = to;
  }
  const std::size_t more = 1 + random() % kMore;
  disturbed.disturb(other, kKnots, kKnots + more, std::nullopt, random() % 2 == 0, takes_over);
  disturbed.finish();
  undisturbed.finish();
  expect_same(disturbed.segments(), undisturbed.segments());
}

TEST_P(DiscardedRevision, OfOtherWaypointsLeavesNoTrace) {
  std::uint64_t seed = 1;
  for (const Tail tail : {Tail::bessel, Tail::parabolic, Tail::natural, Tail::clamped}) {
    for (const std::size_t settle : {0U, 1U, 2U, 3U, 8U, 20U}) {
      for (int round = 0; round < 3; ++round) {
        expect_no_trace_of_others(options(settle, tail), seed, false);
        expect_no_trace_of_others(options(settle, tail), seed++, true);
        if (HasFatalFailure()) return;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Of, DiscardedRevision, ::testing::ValuesIn(testing::streaming_methods()),
                         [](const auto& tested) { return std::string(tested.param->name); });

}  // namespace
}  // namespace splinecast::ipc
