#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "ipc/board/reader.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/sampling/sampler.hpp"
#include "tests/fixtures/curves/mesh.hpp"
#include "tests/fixtures/processes/allocations.hpp"
#include "tests/fixtures/streams/live_stream.hpp"

/// Compares Sampler::sample_many with one call of `preview` per time.
namespace splinecast::ipc {
namespace {

using std::chrono::milliseconds;
using testing::LiveStream;
using testing::MemoryStream;
using testing::Mesh;
using testing::random_mesh;

constexpr double kUntouched = 42;

/// Memory for the samples at several times.
struct Block {
  std::vector<double> values;
  std::vector<SampleStatus> status;
  Derivatives derivatives;

  Block(std::size_t times, std::size_t dimensions, Derivatives asked = Derivatives::all)
      : values(times * count(asked) * dimensions, kUntouched),
        status(times, SampleStatus::busy),
        derivatives(asked) {}
  SampleBlock out() { return {values, status, derivatives}; }
};

/// The values of a state that a block stores: the requested derivatives, in ascending order.
std::vector<double> asked_of(const State& state, Derivatives asked) {
  std::vector<double> values;
  const auto add = [&](Derivatives one, std::span<const double> from) {
    if (contains(asked, one)) values.insert(values.end(), from.begin(), from.end());
  };
  add(Derivatives::position, state.position());
  add(Derivatives::velocity, state.velocity());
  add(Derivatives::acceleration, state.acceleration());
  add(Derivatives::jerk, state.jerk());
  return values;
}

/// Expects the bits, the statuses and the revision of previews at the same times.
void expect_previews(const KnotBoardReader& board, StreamClock clock, const DimensionKinds& kinds,
                     const std::vector<Time>& times, Derivatives asked = Derivatives::all) {
  const std::size_t dimensions = board.dimensions();
  Sampler many(board, clock, kinds);
  Sampler single(board, clock, kinds);
  Block block(times.size(), dimensions, asked);
  ASSERT_EQ(many.sample_many(times, block.out()), board.revision());
  const std::size_t stride = count(asked) * dimensions;
  State state(dimensions);
  for (std::size_t i = 0; i < times.size(); ++i) {
    SCOPED_TRACE(::testing::Message() << "time " << times[i].count());
    const SampleStatus status = single.preview(times[i], state.ref());
    ASSERT_EQ(block.status[i], status);
    const std::vector<double> wanted =
        has_values(status) ? asked_of(state, asked) : std::vector<double>(stride, kUntouched);
    const auto got = std::span(block.values).subspan(i * stride, stride);
    for (std::size_t k = 0; k < stride; ++k) {
      ASSERT_EQ(to_word(got[k]), to_word(wanted[k])) << k;
    }
  }
}

/// A live stream of two runs. A stop and a hold separate them; a stop ends the second run.
struct Runs : LiveStream {
  Runs() {
    put_all(50, 150);
    // The rest position at that time, so that the entry ends at the first waypoint.
    const double rest = position_at(kNow + milliseconds(450));
    std::vector<Waypoint> waypoints;
    for (const int ms : {520, 530, 545}) {
      waypoints.push_back({.time = kNow + milliseconds(ms), .position = {&rest, 1}});
    }
    EXPECT_EQ(ring.writer.replace_from(kNow + milliseconds(500), waypoints, solved()),
              AppendStatus::accepted);
    drain();
    clock.time += milliseconds(60);
    drain();
  }
  /// The ends of all segments ± 1 ns, and times between them.
  [[nodiscard]] static std::vector<Time> times() {
    std::vector<Time> all;
    for (int ms = 0; ms < 1000; ms += 7) all.push_back(kNow + milliseconds(ms));
    for (const int ms : {50, 60, 65, 100, 150, 400, 500, 520, 530, 545, 795}) {
      for (const int ns : {-1, 0, 1}) all.push_back(kNow + milliseconds(ms) + Time(ns));
    }
    all.push_back(Time::min());
    all.push_back(Time::max());
    return all;
  }
};

std::vector<Time> shuffled(std::vector<Time> times) {
  std::shuffle(times.begin(), times.end(), std::mt19937_64(3));
  return times;
}

TEST(SampleMany, EqualsPreviewsBitForBitInAnyOrderOfTimes) {
  Runs live;
  std::vector<Time> times = live.times();
  const auto check = [&] { expect_previews(live.board.reader, StreamClock::monotonic, {}, times); };
  check();
  std::ranges::sort(times);
  check();
  std::ranges::reverse(times);
  check();
  times = shuffled(times);
  check();
  times.insert(times.end(), 40, times[7]);  // the same time 40 times
  check();
}

TEST(SampleMany, ReturnsTheStatusOfEachTime) {
  Runs live;
  const std::vector<Time> times = live.times();
  Block block(times.size(), 1);
  ASSERT_GT(live.sampler.sample_many(times, block.out()), 0U);
  const auto status_at = [&](int ms) {
    const auto at = std::ranges::find(times, LiveStream::kNow + milliseconds(ms));
    return block.status[static_cast<std::size_t>(at - times.begin())];
  };
  EXPECT_EQ(status_at(49), SampleStatus::holding);  // before the first waypoint
  EXPECT_EQ(status_at(50), SampleStatus::settled);
  EXPECT_EQ(status_at(65), SampleStatus::provisional);
  EXPECT_EQ(status_at(150), SampleStatus::stopping);
  EXPECT_EQ(status_at(400), SampleStatus::holding);
  EXPECT_EQ(status_at(500), SampleStatus::provisional);
  EXPECT_EQ(status_at(545), SampleStatus::stopping);
  EXPECT_EQ(status_at(795), SampleStatus::holding);
}

TEST(SampleMany, EqualsPreviewsOfARecordedStreamBeforeAndAfterItsEnd) {
  const Mesh mesh = random_mesh(1, 300, 3, 4);
  MemoryStream stream(3, {}, 64, 64);
  const auto check = [&] {
    std::vector<Time> times = testing::query_times(mesh, 3);
    times.push_back(mesh.times.front() - Time(1));
    times.push_back(mesh.times.back() + std::chrono::seconds(5));
    expect_previews(stream.board.reader, StreamClock::recorded, {}, times);
    expect_previews(stream.board.reader, StreamClock::recorded, {}, shuffled(times));
  };
  stream.send(mesh, 0, 5);
  stream.drain();
  check();
  stream.send(mesh, 5, mesh.size());
  stream.drain();
  check();  // the board no longer holds the first waypoints
  stream.finish();
  check();
}

TEST(SampleMany, ReturnsTheRequestedDerivativesInOrder) {
  const Mesh mesh = random_mesh(2, 60, 5, 4);
  MemoryStream stream(5);
  stream.send(mesh, 0, mesh.size());
  stream.drain();
  for (unsigned asked = 0; asked < 16; ++asked) {
    expect_previews(stream.board.reader, StreamClock::recorded, {}, testing::query_times(mesh, 3),
                    static_cast<Derivatives>(asked));
  }
}

TEST(SampleMany, NormalisesQuaternionsAndWrapsPeriodicDimensions) {
  const std::vector<Dimension> dimensions{
      {.kind = DimensionKind::quaternion},
      {.kind = DimensionKind::quaternion},
      {.kind = DimensionKind::quaternion},
      {.kind = DimensionKind::quaternion},
      {.kind = DimensionKind::periodic, .period = 2 * std::numbers::pi},
      {}};
  const DimensionKinds kinds(dimensions);
  MemoryStream stream(6, {}, 64, 1024, {}, kinds);
  std::vector<Time> times;
  for (int i = 0; i < 50; ++i) {
    const double angle = 0.3 * i;
    const std::vector<double> x{std::sin(angle / 2), 0, 0, std::cos(angle / 2), angle, angle};
    const Time t = i * milliseconds(10);
    stream.send({.time = t, .position = x});
    times.push_back(t);
    times.push_back(t + milliseconds(3));
  }
  stream.drain();
  expect_previews(stream.board.reader, StreamClock::recorded, kinds, times);
  Sampler sampler(stream.board.reader, StreamClock::recorded, kinds);
  Block block(times.size(), 6, Derivatives::position);
  ASSERT_GT(sampler.sample_many(times, block.out()), 0U);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto x = std::span(block.values).subspan(6 * i, 6);
    EXPECT_NEAR(std::hypot(x[0], x[1], std::hypot(x[2], x[3])), 1, 1e-12);
    EXPECT_LE(std::abs(x[4]), std::numbers::pi);
  }
}

TEST(SampleMany, WithoutDataReturnsTheReasonAndLeavesTheValues) {
  const std::vector<Time> times{Time(1), Time(2)};
  MemoryStream stream(1);
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  const auto expect_none = [&](SampleStatus why) {
    Block block(2, 1);
    EXPECT_EQ(sampler.sample_many(times, block.out()), 0U);
    EXPECT_EQ(block.status, std::vector<SampleStatus>(2, why));
    EXPECT_EQ(block.values, std::vector<double>(8, kUntouched));
  };
  expect_none(SampleStatus::no_data);
  const double x = 0;
  stream.send({.time = Time(0), .position = std::span(&x, 1)});
  stream.drain();
  Block block(2, 1);
  EXPECT_EQ(sampler.sample_many(times, block.out()), 1U);
  stream.board.writer.retire();
  expect_none(SampleStatus::retired);
}

TEST(SampleMany, IsBusyForAllTimesIfOneKnotCannotBeCopied) {
  const Mesh mesh = random_mesh(3, 20, 1, 2);
  MemoryStream stream(1);
  stream.send(mesh, 0, mesh.size());
  stream.drain();
  // Makes both cells newer than the revision. A reader otherwise sees this only while a writer is
  // active.
  const BoardLayout& layout = stream.board.layout;
  for (const std::size_t c : {0U, 1U}) {
    words_at(stream.board.bytes.span(), layout.slots + 10 * layout.stride + c * layout.cell, 1)[0] =
        kRetiredTag;
  }
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  const std::vector<Time> times{mesh.times[2], mesh.times[9]};
  Block block(2, 1);
  EXPECT_EQ(sampler.sample_many(times, block.out()), 0U);
  EXPECT_EQ(block.status, std::vector<SampleStatus>(2, SampleStatus::busy));
}

TEST(SampleMany, RefusesBlocksOfTheWrongSize) {
  const Mesh mesh = random_mesh(4, 20, 3, 2);
  MemoryStream stream(3);
  stream.send(mesh, 0, mesh.size());
  stream.drain();
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  const std::vector<Time> times(4, mesh.times[5]);
  const auto expect_refused = [&](std::size_t values, std::size_t statuses, Derivatives asked) {
    std::vector<double> memory(values, kUntouched);
    std::vector<SampleStatus> status(statuses, SampleStatus::busy);
    EXPECT_EQ(sampler.sample_many(times, {memory, status, asked}), 0U);
    EXPECT_EQ(status, std::vector<SampleStatus>(statuses, SampleStatus::wrong_dimension));
    EXPECT_EQ(memory, std::vector<double>(values, kUntouched));
  };
  expect_refused(4 * 3 * 4 - 1, 4, Derivatives::all);
  expect_refused(4 * 3 * 4 + 1, 4, Derivatives::all);
  expect_refused(4 * 3 * 4, 3, Derivatives::all);
  expect_refused(4 * 3 * 4, 5, Derivatives::all);
  expect_refused(4 * 3 * 4, 4, Derivatives::position);
  expect_refused(4 * 3, 4, Derivatives::all);
  expect_refused(0, 4, Derivatives::all);
}

TEST(SampleMany, WithoutTimesReturnsTheRevision) {
  Runs live;
  EXPECT_EQ(live.sampler.sample_many({}, {}), live.board.reader.revision());
  EXPECT_EQ(live.sampler.revision_seen(), live.board.reader.revision());
}

TEST(SampleMany, DoesNotCountAsAnExecutedSample) {
  Runs live;
  const std::vector<Time> ahead{LiveStream::kNow + milliseconds(130)};
  Block block(1, 1);
  ASSERT_GT(live.sampler.sample_many(ahead, block.out()), 0U);
  ASSERT_EQ(
      live.replace(LiveStream::kNow + milliseconds(100), {LiveStream::kNow + milliseconds(120)}),
      AppendStatus::accepted);
  live.drain();
  const Time now = LiveStream::kNow + milliseconds(62);
  EXPECT_EQ(live.sampler.sample(now, live.state.ref()), SampleStatus::settled);
}

TEST(SampleMany, DoesNotConsumeTheRevisedStatusOfAnExecutedSample) {
  Runs live;
  const Time ahead = LiveStream::kNow + milliseconds(130);
  ASSERT_EQ(live.sampler.sample(ahead, live.state.ref()), SampleStatus::provisional);
  ASSERT_EQ(
      live.replace(LiveStream::kNow + milliseconds(100), {LiveStream::kNow + milliseconds(120)}),
      AppendStatus::accepted);
  live.drain();
  const std::vector<Time> times{ahead, LiveStream::kNow + milliseconds(62)};
  Block block(2, 1);
  EXPECT_EQ(live.sampler.sample_many(times, block.out()), live.board.reader.revision());
  for (const SampleStatus status : block.status) EXPECT_NE(status, SampleStatus::revised);
  EXPECT_EQ(live.sampler.sample(times[1], live.state.ref()), SampleStatus::revised);
  EXPECT_EQ(live.sampler.sample(times[1], live.state.ref()), SampleStatus::settled);
}

TEST(SampleMany, AllocatesNothing) {
  const Mesh mesh = random_mesh(5, 100, 7, 3);
  MemoryStream stream(7);
  stream.send(mesh, 0, 50);
  stream.drain();
  Sampler sampler(stream.board.reader, StreamClock::monotonic);
  const auto times = testing::query_times(mesh, 5);
  Block block(times.size(), 7);
  const SampleBlock out = block.out();
  const std::size_t before = testing::allocations();
  const Word revision = sampler.sample_many(times, out);
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_GT(revision, 0U);
}

}  // namespace
}  // namespace splinecast::ipc
