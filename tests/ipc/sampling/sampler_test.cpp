#include "ipc/sampling/sampler.hpp"

#include <gtest/gtest.h>

#include <random>
#include <thread>
#include <vector>

#include "tests/fixtures/curves/mesh.hpp"
#include "tests/fixtures/processes/allocations.hpp"
#include "tests/fixtures/streams/memory_stream.hpp"

namespace splinecast::ipc {
namespace {

using testing::Mesh;
using testing::random_mesh;

struct Stream : testing::MemoryStream {
  explicit Stream(std::size_t dimensions, core::WindowOptions how = {})
      : MemoryStream(dimensions, std::move(how), 1024) {}

  /// Appends waypoints, one revision for each.
  void send(const Mesh& mesh, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      ASSERT_EQ(append(mesh.times[i], mesh.position(i)), AppendStatus::accepted);
      solver.step(clock);
    }
  }
  void finish() { MemoryStream::finish({ConditionKind::halt, {}}); }
};

TEST(Sampler, ReturnsTheStatusOfEachTime) {
  const Mesh mesh = random_mesh(1, 20, 2, 2);
  Stream stream(2, {.settle = 4,
                    .start = {.kind = ConditionKind::halt, .value = {}},
                    .stop_length = Time(1'000'000)});
  Sampler live(stream.board.reader, StreamClock::monotonic);
  Sampler recorded(stream.board.reader, StreamClock::recorded);
  State state(2);
  EXPECT_EQ(live.sample(Time(5), state.ref()), SampleStatus::no_data);
  stream.send(mesh, 0, mesh.size());
  const Time newest = mesh.times.back();
  const Time open = mesh.times[mesh.size() - 1 - 4];
  EXPECT_EQ(recorded.sample(mesh.times[0] - Time(1), state.ref()), SampleStatus::before_history);
  EXPECT_EQ(live.sample(mesh.times[0] - Time(1), state.ref()), SampleStatus::holding);
  EXPECT_EQ(state.position()[0], mesh.position(0)[0]);
  EXPECT_EQ(state.velocity()[0], 0);
  EXPECT_EQ(live.sample(mesh.times[0], state.ref()), SampleStatus::settled);
  EXPECT_EQ(live.sample(open - Time(1), state.ref()), SampleStatus::settled);
  EXPECT_EQ(live.sample(open, state.ref()), SampleStatus::provisional);
  EXPECT_EQ(live.sample(newest - Time(1), state.ref()), SampleStatus::provisional);
  EXPECT_EQ(live.sample(newest, state.ref()), SampleStatus::stopping);
  EXPECT_EQ(live.sample(newest + Time(999'999), state.ref()), SampleStatus::stopping);
  State held(2);
  for (const Time t : {newest + Time(1'000'000), newest + Time(5'000'000'000)}) {
    EXPECT_EQ(live.sample(t, held.ref()), SampleStatus::holding);
    for (std::size_t d = 0; d < 2; ++d) {
      EXPECT_NEAR(held.position()[d], state.position()[d], 1e-8);
      EXPECT_EQ(held.velocity()[d], 0);
      EXPECT_EQ(held.jerk()[d], 0);
    }
  }
  stream.finish();
  EXPECT_EQ(recorded.sample(newest - Time(1), state.ref()), SampleStatus::settled);
  EXPECT_EQ(recorded.sample(newest, state.ref()), SampleStatus::settled);
  EXPECT_EQ(recorded.sample(newest + Time(1), state.ref()), SampleStatus::holding);
  EXPECT_NEAR(state.position()[0], mesh.position(mesh.size() - 1)[0], 1e-12);
  stream.board.writer.retire();
  EXPECT_EQ(recorded.sample(newest, state.ref()), SampleStatus::retired);
}

TEST(Sampler, JumpsGiveTheSameBitsAsAdvancingTime) {
  const Mesh mesh = random_mesh(2, 200, 3, 8);
  Stream stream(3);
  stream.send(mesh, 0, mesh.size());
  stream.finish();
  Sampler advancing(stream.board.reader, StreamClock::recorded);
  const auto times = testing::query_times(mesh, 4);
  std::vector<State> wanted;
  for (const Time t : times) {
    wanted.emplace_back(3);
    ASSERT_EQ(advancing.sample(t, wanted.back().ref()), SampleStatus::settled);
  }
  Sampler jumping(stream.board.reader, StreamClock::recorded);
  State state(3);
  std::mt19937_64 random(7);
  for (int i = 0; i < 5000; ++i) {
    const std::size_t at = random() % times.size();
    ASSERT_EQ(jumping.sample(times[at], state.ref()), SampleStatus::settled);
    ASSERT_TRUE(std::ranges::equal(state.values(), wanted[at].values())) << at;
  }
}

TEST(Sampler, FindsTheSegmentWhenThePackedTimesAreWrong) {
  const Mesh mesh = random_mesh(3, 100, 1, 3);
  Stream stream(1);
  stream.send(mesh, 0, mesh.size());
  stream.finish();
  Sampler honest(stream.board.reader, StreamClock::recorded);
  State wanted(1);
  State state(1);
  std::mt19937_64 random(9);
  const auto hints = words_at(stream.board.bytes.span(), stream.board.layout.times, 1024);
  const std::vector<Word> truth(hints.begin(), hints.end());
  for (int round = 0; round < 500; ++round) {
    std::ranges::copy(truth, hints.begin());
    const Time t = mesh.times[random() % 99] + Time(1);
    ASSERT_EQ(honest.sample(t, wanted.ref()), SampleStatus::settled);
    for (int i = 0; i < 40; ++i) hints[random() % 128] = random();
    Sampler sampler(stream.board.reader, StreamClock::recorded);
    ASSERT_EQ(sampler.sample(t, state.ref()), SampleStatus::settled);
    ASSERT_EQ(state.position()[0], wanted.position()[0]);
  }
}

TEST(Sampler, ASnapshotIsTheCurveOfOneRevision) {
  const Mesh mesh = random_mesh(4, 50, 2, 3);
  Stream stream(2, {.settle = 8});
  stream.send(mesh, 0, mesh.size());
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  BoardSnapshot snapshot(2);
  ASSERT_EQ(sampler.snapshot(mesh.times[10], mesh.times[20], snapshot), SampleStatus::settled);
  ASSERT_EQ(snapshot.segments().size(), 11U);
  EXPECT_EQ(snapshot.segments().front().left, mesh.times[10]);
  EXPECT_EQ(snapshot.segments().back().left, mesh.times[20]);
  for (std::size_t i = 1; i < 11; ++i) {
    EXPECT_EQ(snapshot.segments()[i].left, snapshot.segments()[i - 1].right);
  }
  ASSERT_EQ(sampler.snapshot(mesh.times[30], mesh.times.back() + Time(1), snapshot),
            SampleStatus::provisional);
  EXPECT_EQ(snapshot.segments().back().kind, SegmentKind::stop);
  EXPECT_EQ(sampler.snapshot(mesh.times[0] - Time(1), mesh.times[5], snapshot),
            SampleStatus::before_history);
  EXPECT_TRUE(snapshot.segments().empty());
}

TEST(Sampler, LeavesSpansOfTheWrongSizeUnchanged) {
  const Mesh mesh = random_mesh(7, 20, 3, 2);
  Stream stream(3);
  stream.send(mesh, 0, mesh.size());
  stream.finish();
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  const Time t = mesh.times[10] + Time(1);
  // Guard values on both sides of each span detect writes outside of it.
  std::vector<double> memory(4 * kMaxDimensions + 8, 42.0);
  for (std::size_t part = 0; part < 4; ++part) {
    for (const std::size_t size : {0U, 1U, 2U, 4U, 64U}) {
      std::array<std::span<double>, 4> spans;
      for (std::size_t i = 0; i < 4; ++i) {
        spans[i] = std::span(memory).subspan(4 + i * kMaxDimensions, i == part ? size : 3);
      }
      const StateRef out{spans[0], spans[1], spans[2], spans[3]};
      EXPECT_EQ(sampler.sample(t, out), SampleStatus::wrong_dimension) << part << ' ' << size;
      EXPECT_EQ(sampler.preview(t, out), SampleStatus::wrong_dimension) << part << ' ' << size;
    }
  }
  EXPECT_TRUE(std::ranges::all_of(memory, [](double value) { return value == 42; }));
  EXPECT_FALSE(has_values(SampleStatus::wrong_dimension));
  EXPECT_EQ(to_string(SampleStatus::wrong_dimension), "wrong dimension");
  State state(3);
  EXPECT_EQ(sampler.sample(t, state.ref()), SampleStatus::settled);
}

TEST(Sampler, AStateOrSnapshotOfAnotherStreamIsRefused) {
  const Mesh mesh = random_mesh(8, 20, 3, 2);
  Stream stream(3);
  stream.send(mesh, 0, mesh.size());
  stream.finish();
  const Mesh wider_mesh = random_mesh(9, 20, 5, 2);
  Stream wider(5);
  wider.send(wider_mesh, 0, wider_mesh.size());
  wider.finish();
  State state(3);
  BoardSnapshot snapshot(3);
  Sampler sampler(stream.board.reader, StreamClock::recorded);
  ASSERT_EQ(sampler.sample(mesh.times[5], state.ref()), SampleStatus::settled);
  ASSERT_EQ(sampler.snapshot(mesh.times[5], mesh.times[8], snapshot), SampleStatus::settled);
  sampler = Sampler(wider.board.reader, StreamClock::recorded);
  EXPECT_EQ(sampler.sample(wider_mesh.times[5], state.ref()), SampleStatus::wrong_dimension);
  EXPECT_EQ(sampler.snapshot(wider_mesh.times[5], wider_mesh.times[8], snapshot),
            SampleStatus::wrong_dimension);
  EXPECT_TRUE(snapshot.segments().empty());
}

TEST(Sampler, SamplingAllocatesNothing) {
  const Mesh mesh = random_mesh(5, 100, 7, 3);
  Stream stream(7);
  stream.send(mesh, 0, 50);
  Sampler sampler(stream.board.reader, StreamClock::monotonic);
  State state(7);
  const auto times = testing::query_times(mesh, 5);
  const std::size_t before = testing::allocations();
  std::size_t answered = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const Time t = i % 3 == 0 ? times[times.size() - 1 - i] : times[i];
    if (has_values(sampler.sample(t, state.ref()))) ++answered;
  }
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_EQ(answered, times.size());
}

/// A solver and readers use one mapping, for ThreadSanitizer. Settled samples must equal the final
/// curve bit for bit.
TEST(Sampler, ThreadsReadTheFinalBitsWhileTheSolverRuns) {
  const Mesh mesh = random_mesh(6, 900, 2, 3);
  Stream whole(2);
  whole.send(mesh, 0, mesh.size());
  whole.finish();
  Stream stream(2);
  std::atomic<bool> done{false};
  std::atomic<std::size_t> wrong{0};
  std::atomic<std::size_t> settled{0};
  const auto read = [&](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    Sampler sampler(stream.board.reader, StreamClock::recorded);
    Sampler reference(whole.board.reader, StreamClock::recorded);
    State got(2);
    State wanted(2);
    while (!done.load()) {
      const Time t = mesh.times[random() % 899] + Time(7);
      if (sampler.sample(t, got.ref()) != SampleStatus::settled) continue;
      ++settled;
      (void)reference.sample(t, wanted.ref());
      if (!std::ranges::equal(got.values(), wanted.values())) ++wrong;
    }
  };
  std::vector<std::thread> readers;
  for (std::uint64_t i = 0; i < 3; ++i) readers.emplace_back(read, i);
  stream.send(mesh, 0, mesh.size());
  while (settled.load() < 100) std::this_thread::yield();
  done = true;
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(wrong.load(), 0U);
}

}  // namespace
}  // namespace splinecast::ipc
