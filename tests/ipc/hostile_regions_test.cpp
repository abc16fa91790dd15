#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "splinecast/ipc/errors.hpp"
#include "splinecast/ipc/sampler.hpp"
#include "splinecast/ipc/stream_options.hpp"
#include "support/memory_stream.hpp"

/// What fuzzers have found in regions that hold what no role of ours writes: case by case.
namespace splinecast::ipc {
namespace {

using core::Time;
using testing::MemoryRing;
using testing::MemoryStream;

constexpr Word kLargestWord = std::numeric_limits<Word>::max();
constexpr Time kTick{10'000'000};

/// A recorded stream of one dimension with twelve waypoints, solved.
struct SolvedStream : MemoryStream {
  SolvedStream() : MemoryStream(1, {}, 64, 64) {
    for (int i = 0; i < 12; ++i) {
      const std::vector<double> x{static_cast<double>(i * i)};
      send({.time = i * kTick, .position = x});
      drain();
    }
  }
};

Word& word_of(testing::RegionBytes& bytes, std::size_t offset) {
  return words_at(bytes.span(), offset, 1)[0];
}

/// Word `word` of the cells of segment `number`, both.
void set_cells(MemoryStream& stream, Word number, std::size_t word, Word value) {
  const BoardLayout& layout = stream.board.layout;
  const std::size_t slot = layout.slots + number % layout.capacity * layout.stride;
  for (const std::size_t cell : {std::size_t{0}, layout.cell}) {
    word_of(stream.board.bytes, slot + cell + word * sizeof(Word)) = value;
  }
}

void set_head(MemoryStream& stream, std::size_t word, Word value) {
  for (const std::size_t cell : {std::size_t{0}, kHeadWords}) {
    word_of(stream.board.bytes, stream.board.layout.head + (cell + word) * sizeof(Word)) = value;
  }
}

void set_control(testing::RegionBytes& bytes, std::size_t word, Word value) {
  word_of(bytes, kHeaderBytes + word * sizeof(Word)) = value;
}

TEST(HostileRegions, ACoefficientThatIsNoNumberIsNeverEvaluated) {
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity(), -1e300}) {
    SolvedStream stream;
    set_cells(stream, 3, kCellCoefficients + 1, to_word(value));
    Sampler sampler(stream.board.reader, StreamClock::recorded);
    core::State state(1);
    EXPECT_EQ(sampler.sample(2 * kTick + Time(1), state.ref()), SampleStatus::busy);
    EXPECT_EQ(sampler.sample(4 * kTick + Time(1), state.ref()), SampleStatus::provisional);
    Snapshot snapshot(1);
    EXPECT_EQ(sampler.snapshot(Time(0), 4 * kTick, snapshot), SampleStatus::busy);
  }
}

TEST(HostileRegions, ASegmentThatEndsBeforeItBeginsIsNeverEvaluated) {
  SolvedStream stream;
  set_cells(stream, 3, kCellRight, to_word(Time::min()));
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  core::State state(1);
  EXPECT_EQ(sampler.sample(2 * kTick, state.ref()), SampleStatus::busy);
}

TEST(HostileRegions, ADerivativeOutOfAllProportionLeavesAQuaternionOfNumbers) {
  const std::vector<core::Dimension> four(4, {.kind = core::DimensionKind::quaternion});
  const core::DimensionKinds kinds(four);
  core::State state(4);
  const core::StateRef all = state.ref();
  all.position[3] = 1e-99;
  all.velocity[0] = 1e190;
  kinds.normalise(all);
  for (const double value : state.values()) EXPECT_TRUE(std::isfinite(value));
}

TEST(HostileRegions, TheLastOfAllRevisionsIsReadInBoundedTime) {
  SolvedStream stream;
  set_control(stream.board.bytes, kRevision, kLargestWord);
  Head head;
  EXPECT_TRUE(stream.board.reader.copy_bounds(kLargestWord, kLargestWord, head));
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  core::State state(1);
  EXPECT_EQ(sampler.sample(kTick, state.ref()), SampleStatus::settled);
  EXPECT_THROW(stream.replace_solver(), BadRegion);
}

TEST(HostileRegions, AHeadThatIsNoneLeavesWhatWasCopiedBefore) {
  SolvedStream stream;
  Head head;
  const Word r = stream.board.reader.revision();
  ASSERT_TRUE(stream.board.reader.copy_head(r, head));
  set_head(stream, kHeadNewestKnot, to_word(Time::max()));
  set_head(stream, kHeadRefused, kLargestWord);
  EXPECT_FALSE(stream.board.reader.copy_head(r, head));
  EXPECT_EQ(head.newest_knot, 11 * kTick);
  EXPECT_EQ(head.refused, 0U);
}

TEST(HostileRegions, AHeadFarAheadMakesASolverTakeNoMoreThanARing) {
  SolvedStream stream;
  for (const Word ahead : {kLargestWord / 2, Word{1} << 40U}) {
    set_control(stream.ring.bytes, kHead, stream.solver.head().consumed + ahead);
    const StepResult step = stream.solver.step(stream.clock);
    EXPECT_GT(step.consumed, 0U);
    EXPECT_LE(step.consumed, stream.ring.layout.capacity);
  }
}

TEST(HostileRegions, AHeadThatGoesBackIsWaitedFor) {
  SolvedStream stream;
  set_control(stream.ring.bytes, kHead, 3);
  EXPECT_EQ(stream.solver.step(stream.clock).consumed, 0U);
  EXPECT_EQ(stream.solver.seen(), 3U);  // so that it sleeps until the word changes
}

TEST(HostileRegions, AReplacementAtTheEndOfTimeIsRefused) {
  SolvedStream stream;
  ASSERT_EQ(stream.ring.writer.replace_from(12 * kTick, {}, {stream.board.reader.tail()}),
            AppendStatus::accepted);
  const std::size_t item = stream.ring.layout.items + 12 * stream.ring.layout.stride;
  word_of(stream.ring.bytes, item + kItemTime * sizeof(Word)) = to_word(Time::max());
  EXPECT_EQ(stream.solver.step(stream.clock).consumed, 1U);
  EXPECT_EQ(stream.solver.head().reasons[static_cast<std::size_t>(Refusal::too_late)], 1U);
}

TEST(HostileRegions, AReplacementOfMoreThanTheRingHasEndsWithTheRing) {
  SolvedStream stream;
  ASSERT_EQ(stream.ring.writer.replace_from(12 * kTick, {}, {stream.board.reader.tail()}),
            AppendStatus::accepted);
  const std::size_t item = stream.ring.layout.items + 12 * stream.ring.layout.stride;
  word_of(stream.ring.bytes, item) = static_cast<Word>(ItemKind::replace) | Word{0xffffffff} << 32U;
  word_of(stream.ring.bytes, item + kItemTime * sizeof(Word)) = to_word(Time::min());
  set_control(stream.ring.bytes, kHead, kLargestWord / 2);
  EXPECT_LE(stream.solver.step(stream.clock).consumed, stream.ring.layout.capacity);
}

TEST(HostileRegions, ASolverDoesNotGoOnFromWhatIsNoCurve) {
  const auto refuses = [](const auto& damage) {
    SolvedStream stream;
    damage(stream);
    EXPECT_THROW(stream.replace_solver(), BadRegion);
  };
  refuses([](MemoryStream& s) { set_head(s, kHeadRunKnots, kLargestWord); });
  refuses([](MemoryStream& s) { set_head(s, kHeadRun, 0); });
  refuses([](MemoryStream& s) { set_head(s, kHeadNewest, kLargestWord); });
  refuses([](MemoryStream& s) { set_head(s, kHeadSettledUntil, to_word(Time::max())); });
  refuses([](MemoryStream& s) { set_cells(s, 12, kCellNumber, 5); });
  refuses([](MemoryStream& s) { set_cells(s, 12, kCellLeft, 0); });
  refuses([](MemoryStream& s) { set_cells(s, 12, kCellCoefficients, to_word(std::nan(""))); });
  refuses([](MemoryStream& s) { set_cells(s, 12, kCellShape, 4); });  // no waypoint at its left
}

TEST(HostileRegions, ASolverStopsWhenItsOwnBoardHoldsWhatItHasNotWritten) {
  SolvedStream stream;
  ASSERT_EQ(stream.ring.writer.replace_from(11 * kTick, {}, {stream.board.reader.tail()}),
            AppendStatus::accepted);
  for (Word number = 1; number <= 12; ++number) {
    set_cells(stream, number, kCellCoefficients, to_word(std::nan("")));
  }
  EXPECT_TRUE(stream.solver.step(stream.clock).damaged);
  const Word revision = stream.board.reader.revision();
  EXPECT_TRUE(stream.solver.step(stream.clock).damaged);
  EXPECT_EQ(stream.board.reader.revision(), revision);
}

TEST(HostileRegions, AProducerDoesNotGoOnBehindATimeThatIsNone) {
  MemoryRing ring(1, 8);
  const std::vector<double> x{1};
  ASSERT_EQ(ring.writer.append({.time = Time(0), .position = x}, {}), AppendStatus::accepted);
  word_of(ring.bytes, ring.layout.items + kItemTime * sizeof(Word)) = to_word(Time::min());
  EXPECT_THROW(WaypointRingWriter(ring.bytes.span(), ring.layout, {}), BadRegion);
}

TEST(HostileRegions, ARingAndABoardOfDifferentStreamsAreNotSolved) {
  const RegionHeader ring = make_header({.dimensions = 2}, 7);
  EXPECT_NO_THROW(require_same_stream(ring, ring));
  EXPECT_THROW(require_same_stream(ring, make_header({.dimensions = 2}, 8)), BadRegion);
  EXPECT_THROW(require_same_stream(ring, make_header({.dimensions = 3}, 7)), BadRegion);
  RegionHeader board = ring;
  board.dimension_kind[1] = static_cast<std::uint64_t>(core::DimensionKind::wrap);
  board.period[1] = 1;
  EXPECT_THROW(require_same_stream(ring, board), BadRegion);
  board = ring;
  board.clock = 0;
  EXPECT_THROW(require_same_stream(ring, board), BadRegion);
}

}  // namespace
}  // namespace splinecast::ipc
