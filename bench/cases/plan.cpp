#include <benchmark/benchmark.h>

#include <chrono>
#include <stdexcept>
#include <vector>

#include "bench/harness/bench_stream.hpp"
#include "bench/harness/trips.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/areas.hpp"
#include "ipc/layout/knot_slots.hpp"
#include "ipc/layout/waypoint_items.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/ring/reader.hpp"
#include "ipc/ring/writer.hpp"
#include "ipc/solve/stream_solver.hpp"

namespace splinecast::bench {
namespace {

using std::chrono::milliseconds;

/// A clock whose time the benchmark sets.
class SetClock final : public Clock {
 public:
  [[nodiscard]] Time now() const noexcept override { return time; }
  Time time{};
};

/// A live stream whose solver and producer run in this thread, at simulated times.
class PlannedStream {
 public:
  PlannedStream(std::size_t dimensions, double limit)
      : ring_layout_(ipc::RingLayout::of(dimensions, kRing, ipc::kHeaderBytes)),
        board_layout_(ipc::BoardLayout::of(dimensions, kBoard, ipc::kHeaderBytes, false)),
        ring_region_(ipc::Region::create(ring_layout_.bytes, {})),
        board_region_(ipc::Region::create(board_layout_.bytes, {})),
        ring_writer_(ring_region_.bytes(), ring_layout_, {}),
        ring_(ring_region_.bytes(), ring_layout_),
        board_writer_(board_region_.bytes(), board_layout_),
        board_(board_region_.bytes(), board_layout_),
        solver_(ring_, board_writer_, board_, window(dimensions, limit), {}, {},
                ipc::LiveOptions{}),
        feed_(dimensions) {
    clock_.time = std::chrono::seconds(1000);
  }

  /// Sends waypoints 200 ms ahead for `length`, and solves them.
  void play(Time length) {
    for (const Time end = clock_.time + length; clock_.time < end; clock_.time += kStep) {
      send_until(clock_.time + kLead);
      solver_.step(clock_);
    }
  }
  /// Sends nothing for `length`, so that the stream starves.
  void fall_silent(Time length) {
    for (const Time end = clock_.time + length; clock_.time < end; clock_.time += kStep) {
      solver_.step(clock_);
    }
  }
  /// Sends the waypoints that were held back, and times each step until an entry has been found.
  void return_to_path(Trips& trips, Time cost) {
    constexpr int kMostSteps = 200;
    const MonotonicClock real;
    send_until(clock_.time + kLead);
    for (int i = 0; i < kMostSteps; ++i) {
      const Time before = real.now();
      const auto result = solver_.step(clock_);
      trips.add(real.now() - before - cost);
      if (result.consumed == 0 && solver_.due() > clock_.time) return;
    }
    throw std::runtime_error("no entry was found in 200 steps");
  }

 private:
  static constexpr std::size_t kRing = 256;
  static constexpr std::size_t kBoard = 1024;
  static constexpr Time kLead = milliseconds(200);
  static constexpr Time kStep = milliseconds(1);

  static core::WindowOptions window(std::size_t dimensions, double limit) {
    core::WindowOptions how;
    how.start = {.kind = ConditionKind::halt, .value = {}};
    how.held_before_start = true;
    if (limit > 0) how.limits.acceleration.assign(dimensions, limit);
    return how;
  }

  void send_until(Time t) {
    for (;;) {
      if (!next_) next_ = feed_.next();
      if (!begin_) begin_ = t - next_->time;
      const Time time = *begin_ + next_->time;
      if (time > t) return;
      const ipc::WaypointRingWriter::Solved solved{.consumed = board_.consumed(),
                                                   .settled_until = board_.look().settled_until,
                                                   .clock = &clock_};
      const auto status = ring_writer_.append({.time = time, .position = next_->position}, solved);
      if (status == AppendStatus::full) solver_.step(clock_);
      next_.reset();
    }
  }

  ipc::RingLayout ring_layout_;
  ipc::BoardLayout board_layout_;
  ipc::Region ring_region_;
  ipc::Region board_region_;
  ipc::WaypointRingWriter ring_writer_;
  ipc::WaypointRingReader ring_;
  ipc::KnotBoardWriter board_writer_;
  ipc::KnotBoardReader board_;
  ipc::StreamSolver solver_;
  SetClock clock_;
  Feed feed_;
  std::optional<Waypoint> next_;
  std::optional<Time> begin_;
};

/// Times each step of a solver that returns to the waypoints after 300 ms without any: it consumes
/// all the waypoints that were held back, searches for the entry and publishes it.
void plan(benchmark::State& bench) {
  constexpr std::size_t kSilences = 400;
  constexpr std::size_t kMostSteps = 64;
  const auto dimensions = static_cast<std::size_t>(bench.range(0));
  // The peak acceleration of the motion itself is about 40 unit/s².
  constexpr double kLimit = 60;
  const Pinned pin(kNear);
  const Time cost = clock_cost();
  for (auto _ : bench) {
    PlannedStream stream(dimensions, bench.range(1) > 0 ? kLimit : 0);
    Trips trips(kSilences * kMostSteps);
    for (std::size_t i = 0; i < kSilences; ++i) {
      stream.play(milliseconds(700));
      stream.fall_silent(milliseconds(300));
      stream.return_to_path(trips, cost);
    }
    nlohmann::json summary = trips.summary();
    report(bench, summary);
    bench.counters["worst_ns"] = trips.quantile(1);
    bench.counters["steps"] = static_cast<double>(trips.size()) / kSilences;
  }
}

BENCHMARK(plan)
    ->ArgNames({"dims", "limits"})
    ->ArgsProduct({{7}, {0, 1}})
    ->Args({1, 1})
    ->Args({32, 1})
    ->Iterations(1)
    ->UseManualTime();

}  // namespace
}  // namespace splinecast::bench
