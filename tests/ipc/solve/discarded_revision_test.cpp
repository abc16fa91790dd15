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

/// A revision that is discarded, because it came too late or its solver died, leaves no trace in
/// what this solver or a later one computes: the curve has the bits of an undisturbed one.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using testing::Trial;

constexpr std::size_t kDimensions = 2;
constexpr std::size_t kFirstKnots = 20;  ///< of the run that a replacement cuts
constexpr std::size_t kKnots = 40;
constexpr Time kTick = milliseconds(10);

/// A solver held up for hours between its first look at the clock and the one before the commit.
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

/// A live stream. After each item the first revision that would change the curve is made as late as
/// its disturbance says, and then all are made in time.
class Stream {
 public:
  Stream(const core::WindowOptions& how, Disturbance disturbance)
      : disturbance_(disturbance),
        stream_(kDimensions, how, 64, 256, {}, {}, LiveOptions{.history = std::chrono::hours(1)}),
        trial_(testing::random_trial(5, kKnots, kDimensions, 4)) {
    Time t = 3 * kTick;
    for (Time& time : trial_.mesh.times) time = t += kTick;
  }

  /// Appends waypoints one by one, replaces the future with a run of `entered` waypoints, goes on,
  /// and finishes. Returns all segments.
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
    EXPECT_TRUE(stream_.solver.head().finished);
    EXPECT_EQ(stream_.solver.head().refused, 0U);
    EXPECT_EQ(stream_.solver.head().knots, kKnots);
    // Of other items nothing but the counts changes.
    if (disturbance_ != Disturbance::none) {
      EXPECT_GT(discarded_, kKnots / 2);
    }
    SettledSegments settled(stream_.board.reader, true);
    settled.look();
    return {settled.segments().begin(), settled.segments().end()};
  }

 private:
  [[nodiscard]] WaypointRingWriter::Solved solved() {
    return {stream_.board.reader.tail(), stream_.board.reader.look().settled_until, &stream_.clock};
  }
  void append(const Waypoint& waypoint) {
    EXPECT_EQ(stream_.ring.writer.append(waypoint, solved()), AppendStatus::accepted);
    step();
    stream_.clock.time += kTick;
  }
  void step() {
    // Early enough for the waypoints to be ahead of what settles; then the clock follows them.
    if (disturbance_ != Disturbance::none && misses_one(true)) {
      ++discarded_;
      if (disturbance_ == Disturbance::missed_and_taken_over) stream_.replace_solver();
    }
    EXPECT_FALSE(misses_one(false));
  }
  /// Steps until a revision is discarded, or there is nothing more to do at this time: a search for
  /// an entry takes several steps, of which some publish nothing.
  [[nodiscard]] bool misses_one(bool is_held_up) {
    constexpr int kMostSteps = 100;
    for (int i = 0; i < kMostSteps; ++i) {
      const HeldUpClock late(stream_.clock.time);
      const Clock& clock = stream_.clock;
      if (stream_.solver.step(is_held_up ? static_cast<const Clock&>(late) : clock).missed)
        return true;
      if (stream_.solver.due() > stream_.clock.time) return false;
    }
    ADD_FAILURE() << "steps without an end";
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
    expect_same(Stream(how, Disturbance::missed_and_taken_over).play(entered), wanted);
  }
};

TEST_P(DiscardedRevision, LeavesNoTraceWhateverTheLag) {
  for (const std::size_t settle : {0U, 1U, 2U, 3U, 8U, 64U}) expect_no_trace(options(settle), 3);
}

TEST_P(DiscardedRevision, LeavesNoTraceWhateverTheTail) {
  for (const Tail tail : {Tail::bessel, Tail::parabolic, Tail::natural, Tail::rest}) {
    expect_no_trace(options(4, tail), 2);
  }
}

TEST_P(DiscardedRevision, LeavesNoTraceInRunsOfOneToFiveKnots) {
  for (std::size_t entered = 1; entered <= 5; ++entered) {
    for (const std::size_t settle : {0U, 2U, 8U}) expect_no_trace(options(settle), entered);
  }
}

/// A curve and its board, without a solver: what is discarded may be anything, whatever follows.
class Curve {
 public:
  explicit Curve(const core::WindowOptions& how)
      : how_(how), board_(kDimensions, 64, how.interpolant.method->smooths()) {
    take_over();
  }

  /// Publishes waypoints `from` to `to` of a trial, in one revision; first the curve is cut at
  /// `entry`, if there is one.
  void publish(const Trial& trial, std::size_t from, std::size_t to, std::optional<Time> entry) {
    change(trial, from, to, entry);
    head_.changed_from = curve_->write();
    put_summary(curve_->summary(), head_);
    ASSERT_TRUE(board_.writer.is_sound());
    board_.writer.commit(head_);
    curve_->committed(head_);
  }
  void finish() {
    expect_finish();
    head_.finished = true;
    publish({}, 0, 0, std::nullopt);
  }

  /// The same, or a finish, discarded: by its own writer, or by the next one.
  void disturb(const Trial& other, std::size_t from, std::size_t to, std::optional<Time> entry,
               bool finishes, bool takes_over) {
    change(other, from, to, entry);
    if (finishes) expect_finish();
    (void)curve_->write();
    if (takes_over) {
      take_over();
    } else {
      board_.writer.discard();
      curve_->restore(head_);
    }
    ASSERT_FALSE(curve_->is_damaged());
  }

  /// Everything that the board holds.
  [[nodiscard]] std::vector<SegmentCopy> segments() const {
    std::vector<SegmentCopy> all;
    BoardSegment segment(kDimensions, board_.reader.smooths());
    for (Word n = head_.first; n <= head_.newest && n > 0;) {
      const auto taken = segment.take(board_.reader, head_, n);
      if (taken == BoardSegment::Taken::none && n == head_.newest) break;
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
    curve_->restore(head_);
  }
  void change(const Trial& trial, std::size_t from, std::size_t to, std::optional<Time> entry) {
    curve_->freeze(Time::min());
    if (entry) curve_->begin_run(*entry, Time::zero());
    for (std::size_t i = from; i < to; ++i) curve_->append(trial.waypoints()[i], i);
    int tries = kTries;
    curve_->plan(Time::min(), Time::max(), true, tries);
  }
  void expect_finish() {
    int tries = kTries;
    EXPECT_TRUE(curve_->finish({ConditionKind::halt, {}}, Time::min(), Time::max(), tries));
  }

  static constexpr int kTries = 1000;  // a search is never interrupted

  core::WindowOptions how_;
  testing::MemoryBoard board_;
  std::optional<PublishedCurve> curve_;
  Head head_;
};

/// A time at which the curve is cut: in the last interval before waypoint `from`.
Time before_waypoint(const Trial& trial, std::size_t from) {
  return trial.mesh.times[from - 1] - (trial.mesh.times[from - 1] - trial.mesh.times[from - 2]) / 3;
}

/// Other waypoints than a trial's, each a nanosecond later.
Trial beside(const Trial& trial, std::uint64_t seed) {
  Trial other = testing::random_trial(seed, trial.mesh.size(), kDimensions, 4);
  for (std::size_t i = 0; i < trial.mesh.size(); ++i) {
    other.mesh.times[i] = trial.mesh.times[i] + Time(1);
  }
  return other;
}

/// Discards up to two revisions of other waypoints from `next` on.
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

/// Publishes waypoints in revisions of one to three, enters runs of one to five knots, and
/// finishes; beside it the same with revisions of other waypoints that are discarded. A solver that
/// takes over knows less of what the motion has shown: then there are limits.
void expect_no_trace_of_others(core::WindowOptions how, std::uint64_t seed, bool takes_over) {
  if (takes_over) how.limits.acceleration.assign(kDimensions, 100);
  SCOPED_TRACE(::testing::Message() << "lag " << how.settle << ", seed " << seed);
  constexpr std::size_t kMore = 3;  // behind the last one that is published
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
  for (const Tail tail : {Tail::bessel, Tail::parabolic, Tail::natural, Tail::rest}) {
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
