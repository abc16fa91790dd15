#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "core/laws/law_path.hpp"
#include "ipc/ring/item_words.hpp"
#include "ipc/sampling/sampler.hpp"
#include "ipc/solve/law_planner.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/method.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// Plans of a time law that its solver takes in the step in which they are made.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using testing::MemoryStream;

constexpr Time kStart = milliseconds(100);

core::WindowOptions law_window() {
  core::WindowOptions window{.interpolant = {.method = find_method("quintic")}};
  window.settle = window.interpolant.method->look_ahead;
  window.limits.acceleration = {1e12};
  return window;
}

/// A law whose planner does what the test says.
class Law : public ::testing::Test, public LawPlanner {
 protected:
  Law()
      : stream_(1, law_window(), 64, 64, {Time(1), kLatestTime / 2}, {},
                LiveOptions{.least_entry = Time(1)}) {
    stream_.replace_producer();  // with the limits of a law
    stream_.solver.plan_with(*this);
    next_ = [this](Time /*settled*/) {
      core::LawPath path({.time = kStart, .position = 0, .rate = 1, .slope = 0});
      path.add_begin();
      path.add_line();
      EXPECT_EQ(stream_.ring.writer.replace_from(kStart - Time(1), path.waypoints(), solved()),
                AppendStatus::accepted);
    };
    step(milliseconds(0));
    EXPECT_EQ(stream_.board.reader.consumed(), 3U);
    step(kStart);
  }

  LawPlan plan(Time /*now*/, Time settled) noexcept override {
    if (const auto action = std::exchange(next_, nullptr)) action(settled);
    return {};
  }

  WaypointRingWriter::Solved solved() {
    return {stream_.board.reader.consumed(), stream_.board.reader.look().settled_until};
  }

  /// Plans from the settled time on.
  void plan_next(const std::vector<RateItem>& pieces) {
    next_ = [this, pieces](Time settled) { append(settled, pieces); };
  }
  void append(Time begin, const std::vector<RateItem>& pieces) {
    core::RateCurve curve(begin, {});
    for (const RateItem& piece : pieces) curve.add(piece.end_rate, piece.length);
    EXPECT_EQ(stream_.ring.writer.append_plan(curve.pieces(), 3, 77, solved()),
              AppendStatus::accepted);
  }

  StepResult step(Time now) {
    stream_.clock.time = now;
    return stream_.solver.step(stream_.clock);
  }

  /// The words of item `i` of the ring.
  std::span<Word> item(Word i) {
    const std::size_t stride = words_per_item(stream_.ring.layout);
    return words_at(stream_.ring.bytes.span(), stream_.ring.layout.items, 64 * stride)
        .subspan((i & 63U) * stride, stride);
  }

  double rate_at(Time t) {
    Sampler sampler(stream_.board.reader, StreamClock::monotonic);
    State state(1);
    EXPECT_TRUE(has_values(sampler.preview(t, state.ref())));
    return state.velocity()[0];
  }

  std::function<void(Time)> next_;
  MemoryStream stream_;
};

TEST_F(Law, BeginsWithBothWaypointsInOneRevision) {
  EXPECT_EQ(stream_.board.reader.revision(), 1U);
  EXPECT_EQ(stream_.solver.summary().newest, 2U);
  EXPECT_EQ(rate_at(milliseconds(200)), 1);
}

TEST_F(Law, TakesAPlanInTheStepThatMakesIt) {
  plan_next({{0.5, milliseconds(100)}, {0.2, milliseconds(50)}});
  EXPECT_EQ(step(milliseconds(200)).consumed, 2U);
  const Time begin = milliseconds(205);
  EXPECT_EQ(rate_at(begin), 1);
  EXPECT_EQ(rate_at(begin + milliseconds(100)), 0.5);
  EXPECT_EQ(rate_at(begin + milliseconds(150)), 0.2);
  EXPECT_EQ(rate_at(begin + std::chrono::hours(24 * 365)), 0.2);
  EXPECT_EQ(stream_.solver.summary().controls, 3U);
  EXPECT_EQ(stream_.solver.summary().consumed, 5U);
  RingItem copy(1);
  stream_.ring.reader.copy(3, copy);
  EXPECT_EQ(copy.commander, 3);
  EXPECT_EQ(copy.request(), 77U);
  EXPECT_EQ(copy.count, 1U);
  EXPECT_EQ(copy.time, begin);
}

TEST_F(Law, FollowsEachPieceOfAPlan) {
  const Time begin = milliseconds(205);
  core::RateCurve expected(begin, {.rate = 1, .slope = 0});
  expected.add(0.9, milliseconds(20));
  expected.add(0.5, milliseconds(40));
  expected.add(0.2, milliseconds(30));
  plan_next({{0.9, milliseconds(20)}, {0.5, milliseconds(40)}, {0.2, milliseconds(30)}});
  EXPECT_EQ(step(milliseconds(200)).consumed, 3U);
  for (Time t = begin; t < expected.end() + milliseconds(5); t += milliseconds(1)) {
    EXPECT_NEAR(rate_at(t), expected.at(t).rate, 1e-11) << t.count();
  }
}

TEST_F(Law, WithdrawsWhatAnEarlierSolverHasLeft) {
  append(milliseconds(300), {{0, milliseconds(100)}});
  stream_.replace_solver();
  stream_.solver.plan_with(*this);
  EXPECT_EQ(step(milliseconds(200)).consumed, 1U);
  EXPECT_EQ(stream_.solver.summary().withdrawn, 1U);
  EXPECT_EQ(stream_.board.reader.consumed(), 4U);
  EXPECT_EQ(rate_at(milliseconds(500)), 1);
}

/// A clock that advances between its first reading and the following ones.
class LateClock final : public Clock {
 public:
  explicit LateClock(Time now) : now_(now) {}
  [[nodiscard]] Time now() const noexcept override {
    return std::exchange(is_first_, false) ? now_ : now_ + milliseconds(50);
  }

 private:
  Time now_;
  mutable bool is_first_ = true;
};

TEST_F(Law, PlansAgainWhenARevisionIsTooLate) {
  plan_next({{0, milliseconds(10)}});
  EXPECT_TRUE(stream_.solver.step(LateClock(milliseconds(200))).missed);
  EXPECT_EQ(rate_at(milliseconds(400)), 1);
  plan_next({{0, milliseconds(10)}});
  EXPECT_EQ(step(milliseconds(250)).consumed, 2U);
  EXPECT_EQ(stream_.solver.summary().withdrawn, 1U);
  EXPECT_EQ(rate_at(milliseconds(255)), 1);
  EXPECT_EQ(rate_at(milliseconds(265)), 0);
}

/// What a damaged word makes of a plan of two pieces, and the reason for which it is refused.
struct Damage {
  std::size_t piece;
  std::size_t word;
  Word value;
  Refusal reason;
};

TEST_F(Law, RefusesAPlanThatNoPlannerWrites) {
  const Word kind = static_cast<Word>(ItemKind::rate) | kHasVelocity | kHasAcceleration;
  const Word late = to_word(milliseconds(1));
  const std::array damages{
      Damage{0, kItemKind, kind | Word{3} << kCountShift, Refusal::unknown_kind},
      Damage{0, kItemKind, kind | Word{0xffffffff} << kCountShift, Refusal::unknown_kind},
      Damage{0, kItemKind, kind | Word{1} << kPlaceShift | Word{1} << kCountShift,
             Refusal::unknown_kind},
      Damage{1, kItemKind, kind, Refusal::unknown_kind},
      Damage{1, kItemKind, static_cast<Word>(ItemKind::waypoint), Refusal::unknown_kind},
      Damage{0, kItemTime, late, Refusal::too_late},
      Damage{0, kItemTime, ~Word{0} >> 1U, Refusal::too_late},
      Damage{0, kItemValues, std::bit_cast<Word>(-0.1), Refusal::not_finite},
      Damage{0, kItemValues, std::bit_cast<Word>(1e300), Refusal::not_finite},
      Damage{1, kItemValues, ~Word{0}, Refusal::not_finite},
      Damage{1, kItemValues + 1, 0, Refusal::not_finite},
      Damage{1, kItemValues + 1, std::bit_cast<Word>(1e300), Refusal::not_finite},
  };
  Time now = milliseconds(200);
  for (const Damage& damage : damages) {
    const Word first = stream_.ring.writer.written();
    const auto reasons = stream_.solver.summary().reasons;
    next_ = [&](Time settled) {
      append(settled, {{0.5, milliseconds(10)}, {0, milliseconds(10)}});
      item(first + damage.piece)[damage.word] = damage.value;
    };
    EXPECT_GE(step(now).consumed, 1U);
    EXPECT_EQ(stream_.solver.summary().reasons[static_cast<std::size_t>(damage.reason)] -
                      reasons[static_cast<std::size_t>(damage.reason)] >
                  0,
              true)
        << "word " << damage.word << " of piece " << damage.piece << ": " << damage.value;
    EXPECT_EQ(rate_at(now + milliseconds(100)), 1) << "word " << damage.word;
    EXPECT_EQ(stream_.board.reader.consumed(), first + 2);
    now += milliseconds(10);
  }
}

TEST(ALawsPlan, IsRefusedOnAnotherStream) {
  MemoryStream stream(1, law_window(), 64, 64, {}, {}, LiveOptions{});
  core::RateCurve curve(milliseconds(100), {});
  curve.add(0, milliseconds(10));
  EXPECT_EQ(stream.ring.writer.append_plan(curve.pieces(), 0, 1, {}), AppendStatus::accepted);
  EXPECT_EQ(stream.solver.step(stream.clock).consumed, 1U);
  EXPECT_EQ(stream.solver.summary().reasons[static_cast<std::size_t>(Refusal::unknown_kind)], 1U);
}

}  // namespace
}  // namespace splinecast::ipc
