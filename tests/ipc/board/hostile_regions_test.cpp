#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/layout/areas.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/ring_control.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/ring/writer.hpp"
#include "ipc/sampling/sampler.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/options.hpp"
#include "tests/fixtures/streams/board_words.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

/// Faults that fuzzers found in regions whose bytes no role of this library writes.
namespace splinecast::ipc {
namespace {

using testing::MemoryRing;
using testing::MemoryStream;
using testing::summary_word;

constexpr Word kLargestWord = std::numeric_limits<Word>::max();
constexpr Time kTick{10'000'000};
constexpr Word kWaypointBit = Word{1} << 5U;  // of a tag

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

/// Offset of one part of a knot's slot, for copy c = 0 or 1.
using Offset = std::size_t (*)(const BoardLayout&, Word number, std::size_t c);
void set_both(MemoryStream& stream, Offset offset, Word number, std::size_t word, Word value) {
  for (const std::size_t c : {0U, 1U}) {
    word_of(stream.board.bytes, offset(stream.board.layout, number, c) + word * sizeof(Word)) =
        value;
  }
}

void set_cells(MemoryStream& stream, Word number, std::size_t word, Word value) {
  set_both(stream, testing::cell_offset, number, word, value);
}

void set_nodes(MemoryStream& stream, Word number, std::size_t word, Word value) {
  set_both(stream, testing::node_offset, number, word, value);
}

void set_rows(MemoryStream& stream, Word number, std::size_t word, Word value) {
  set_both(stream, testing::row_offset, number, word, value);
}

/// Flips bits in both tags of a knot.
void flip_tag_bits(MemoryStream& stream, Word number, Word bits) {
  for (const std::size_t c : {0U, 1U}) {
    word_of(stream.board.bytes, testing::cell_offset(stream.board.layout, number, c)) ^= bits;
  }
}

void set_summary(MemoryStream& stream, std::size_t word, Word value) {
  for (const std::size_t c : {0U, 1U}) {
    word_of(stream.board.bytes,
            testing::summary_offset(stream.board.layout, c) + word * sizeof(Word)) = value;
  }
}

void set_control(testing::RegionBytes& bytes, std::size_t word, Word value) {
  word_of(bytes, kHeaderBytes + word * sizeof(Word)) = value;
}

TEST(HostileRegions, AKnotWithAnInvalidValueIsNeverEvaluated) {
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity(), -1e300}) {
    for (const bool is_velocity : {false, true}) {
      SolvedStream stream;
      if (is_velocity) {
        set_cells(stream, 3, kCellVelocity, to_word(value));
      } else {
        set_nodes(stream, 3, kNodePosition, to_word(value));
      }
      Sampler sampler(stream.board.reader, StreamClock::recorded);
      State state(1);
      // Both segments that meet at the knot use its values.
      EXPECT_EQ(sampler.sample(kTick + Time(1), state.ref()), SampleStatus::busy);
      EXPECT_EQ(sampler.sample(2 * kTick + Time(1), state.ref()), SampleStatus::busy);
      EXPECT_EQ(sampler.sample(4 * kTick + Time(1), state.ref()), SampleStatus::provisional);
      BoardSnapshot snapshot(1);
      EXPECT_EQ(sampler.snapshot(Time(0), 4 * kTick, snapshot), SampleStatus::busy);
    }
  }
}

TEST(HostileRegions, ASegmentThatEndsBeforeItBeginsIsNeverEvaluated) {
  for (const Time time : {Time::min(), 3 * kTick, 4 * kTick, kLatestTime + Time(1), Time::max()}) {
    SolvedStream stream;
    set_nodes(stream, 3, kNodeTime, to_word(time));
    Sampler sampler(stream.board.reader, StreamClock::recorded);
    State state(1);
    EXPECT_EQ(sampler.sample(2 * kTick, state.ref()), SampleStatus::busy) << time.count();
  }
}

TEST(HostileRegions, ASegmentFormInvalidForTheStreamIsNeverEvaluated) {
  constexpr unsigned kFormShift = 1;
  constexpr Word kCubic = static_cast<Word>(core::SegmentForm::cubic);
  for (Word form = 0; form < 16; ++form) {
    const auto known = static_cast<core::SegmentForm>(form);
    const bool is_made_of_the_same =
        known == core::SegmentForm::cubic || known == core::SegmentForm::halt_left ||
        known == core::SegmentForm::halt_right || known == core::SegmentForm::halt_both ||
        known == core::SegmentForm::hold;
    if (is_made_of_the_same) continue;
    SolvedStream stream;
    flip_tag_bits(stream, 3, (kCubic ^ form) << kFormShift);
    Sampler sampler(stream.board.reader, StreamClock::recorded);
    State state(1);
    // With form `none`, the previous segment would end after its own right knot.
    EXPECT_EQ(sampler.sample(2 * kTick + Time(1), state.ref()), SampleStatus::busy) << form;
  }
}

TEST(HostileRegions, NormalisingAQuaternionWithAHugeVelocityGivesFiniteValues) {
  const std::vector<Dimension> four(4, {.kind = DimensionKind::quaternion});
  const DimensionKinds kinds(four);
  State state(4);
  const StateRef all = state.ref();
  all.position[3] = 1e-99;
  all.velocity[0] = 1e190;
  kinds.normalise(all);
  for (const double value : state.values()) EXPECT_TRUE(std::isfinite(value));
}

TEST(HostileRegions, TheLargestRevisionIsReadInBoundedTime) {
  SolvedStream stream;
  set_control(stream.board.bytes, kRevision, kLargestWord);
  Summary summary;
  EXPECT_TRUE(stream.board.reader.copy_bounds({.settled_until = {}, .revision = kLargestWord},
                                              kLargestWord, summary));
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  State state(1);
  EXPECT_EQ(sampler.sample(kTick, state.ref()), SampleStatus::settled);
  EXPECT_THROW(stream.replace_solver(), BadRegion);
}

TEST(HostileRegions, AnInvalidSummaryLeavesThePreviousCopyUnchanged) {
  SolvedStream stream;
  Summary summary;
  const Look look = stream.board.reader.look();
  ASSERT_TRUE(stream.board.reader.copy_summary(look, summary));
  set_summary(stream, summary_word("newest time"), to_word(Time::max()));
  set_summary(stream, summary_word("refused"), kLargestWord);
  EXPECT_FALSE(stream.board.reader.copy_summary(look, summary));
  EXPECT_EQ(summary.newest_time, 11 * kTick);
  EXPECT_EQ(summary.refused, 0U);
}

TEST(HostileRegions, AWrittenPositionFarAheadMakesASolverTakeAtMostOneRing) {
  SolvedStream stream;
  for (const Word ahead : {kLargestWord / 2, Word{1} << 40U}) {
    set_control(stream.ring.bytes, kWritten, stream.solver.summary().consumed + ahead);
    const StepResult step = stream.solver.step(stream.clock);
    EXPECT_GT(step.consumed, 0U);
    EXPECT_LE(step.consumed, stream.ring.layout.capacity);
  }
}

TEST(HostileRegions, ASolverWaitsWhenTheWrittenPositionDecreases) {
  SolvedStream stream;
  set_control(stream.ring.bytes, kWritten, 3);
  EXPECT_EQ(stream.solver.step(stream.clock).consumed, 0U);
  EXPECT_EQ(stream.solver.seen(), 3U);  // the solver sleeps until the word changes
}

TEST(HostileRegions, AReplacementAfterTheLatestTimeIsRefused) {
  SolvedStream stream;
  ASSERT_EQ(stream.ring.writer.replace_from(12 * kTick, {}, {stream.board.reader.consumed()}),
            AppendStatus::accepted);
  const std::size_t item = stream.ring.layout.items + 12 * stream.ring.layout.stride;
  word_of(stream.ring.bytes, item + kItemTime * sizeof(Word)) = to_word(Time::max());
  EXPECT_EQ(stream.solver.step(stream.clock).consumed, 1U);
  EXPECT_EQ(stream.solver.summary().reasons[static_cast<std::size_t>(Refusal::too_far_apart)], 1U);
}

TEST(HostileRegions, AReplacementLongerThanTheRingEndsWithTheRing) {
  SolvedStream stream;
  ASSERT_EQ(stream.ring.writer.replace_from(12 * kTick, {}, {stream.board.reader.consumed()}),
            AppendStatus::accepted);
  const std::size_t item = stream.ring.layout.items + 12 * stream.ring.layout.stride;
  word_of(stream.ring.bytes, item) = static_cast<Word>(ItemKind::replace) | Word{0xffffffff} << 32U;
  word_of(stream.ring.bytes, item + kItemTime * sizeof(Word)) = to_word(Time::min());
  set_control(stream.ring.bytes, kWritten, kLargestWord / 2);
  EXPECT_LE(stream.solver.step(stream.clock).consumed, stream.ring.layout.capacity);
}

TEST(HostileRegions, ASolverRefusesToTakeOverADamagedCurve) {
  const auto refuses = [](const auto& damage) {
    SolvedStream stream;
    damage(stream);
    EXPECT_THROW(stream.replace_solver(), BadRegion);
  };
  refuses([](MemoryStream& s) { set_summary(s, summary_word("knots of the run"), kLargestWord); });
  refuses([](MemoryStream& s) { set_summary(s, summary_word("run"), 0); });
  refuses([](MemoryStream& s) { set_summary(s, summary_word("newest"), kLargestWord); });
  refuses([](MemoryStream& s) { set_summary(s, summary_word("stop"), to_word(Time::max())); });
  refuses([](MemoryStream& s) { set_control(s.board.bytes, kSettledUntil, to_word(Time::max())); });
  refuses([](MemoryStream& s) { set_nodes(s, 12, kNodeTime, 0); });
  refuses([](MemoryStream& s) { set_nodes(s, 12, kNodePosition, to_word(std::nan(""))); });
  refuses([](MemoryStream& s) { set_cells(s, 11, kCellVelocity, to_word(std::nan(""))); });
  refuses([](MemoryStream& s) { set_rows(s, 12, kRowGamma, to_word(std::nan(""))); });
  refuses([](MemoryStream& s) { set_rows(s, 12, kRowG, to_word(std::nan(""))); });
  refuses([](MemoryStream& s) { flip_tag_bits(s, 11, kWaypointBit); });  // not a waypoint
  refuses([](MemoryStream& s) { set_cells(s, 12, kCellTag, kRetiredTag); });
}

TEST(HostileRegions, ASolverStopsWhenItsBoardHoldsValuesItDidNotWrite) {
  SolvedStream stream;
  ASSERT_EQ(stream.ring.writer.replace_from(11 * kTick, {}, {stream.board.reader.consumed()}),
            AppendStatus::accepted);
  for (Word number = 1; number <= 12; ++number) {
    set_cells(stream, number, kCellVelocity, to_word(std::nan("")));
  }
  EXPECT_TRUE(stream.solver.step(stream.clock).damaged);
  const Word revision = stream.board.reader.revision();
  EXPECT_TRUE(stream.solver.step(stream.clock).damaged);
  EXPECT_EQ(stream.board.reader.revision(), revision);
}

TEST(HostileRegions, AProducerRefusesToContinueAfterAnInvalidTime) {
  MemoryRing ring(1, 8);
  const std::vector<double> x{1};
  ASSERT_EQ(ring.writer.append({.time = Time(0), .position = x}, {}), AppendStatus::accepted);
  word_of(ring.bytes, ring.layout.items + kItemTime * sizeof(Word)) = to_word(Time::min());
  EXPECT_THROW(WaypointRingWriter(ring.bytes.span(), ring.layout, {}), BadRegion);
}

TEST(HostileRegions, ARingAndABoardOfDifferentStreamsAreRefused) {
  const RegionHeader ring = make_header({.dimensions = 2}, 7);
  EXPECT_NO_THROW(require_same_stream(ring, ring));
  EXPECT_THROW(require_same_stream(ring, make_header({.dimensions = 2}, 8)), BadRegion);
  EXPECT_THROW(require_same_stream(ring, make_header({.dimensions = 3}, 7)), BadRegion);
  RegionHeader board = ring;
  board.dimension_kind[1] = static_cast<std::uint64_t>(DimensionKind::periodic);
  board.period[1] = 1;
  EXPECT_THROW(require_same_stream(ring, board), BadRegion);
  board = ring;
  board.clock = 0;
  EXPECT_THROW(require_same_stream(ring, board), BadRegion);
}

}  // namespace
}  // namespace splinecast::ipc
