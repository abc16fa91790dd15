#include "support/threaded_stream.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <random>
#include <thread>
#include <vector>

#include "splinecast/ipc/sampler.hpp"

namespace splinecast::testing {
namespace {

using core::Time;
using ipc::Word;

constexpr std::size_t kDimensions = 3;
constexpr std::size_t kRingCapacity = 16;
constexpr std::size_t kBoardCapacity = 256;
constexpr Time kInterval{1'000'000};
constexpr Time kLead = 20 * kInterval;
constexpr std::size_t kMostReplacing = 8;
constexpr std::uint64_t kBurst = 256;  ///< rounds of a reader before it lets others run
constexpr ipc::LiveOptions kLive{
    .freeze_ahead = 5 * kInterval, .history = 100 * kInterval, .min_splice = 2 * kInterval};

using Values = std::array<double, kDimensions>;

/// The values that go with one: exact multiples.
Values with(double value) { return {value, 2 * value, -value}; }

bool is_whole(std::span<const double> values) {
  return values[1] == 2 * values[0] && values[2] == -values[0];
}

/// The position at a time: anywhere between −1 and 1.
double position_at(Time t) {
  const auto mixed = static_cast<Word>(t.count()) * 0x9e3779b97f4a7c15;
  return static_cast<double>(static_cast<std::int64_t>(mixed) >> 11) * 0x1p-52;
}

class AtomicClock final : public ipc::Clock {
 public:
  [[nodiscard]] Time now() const noexcept override { return Time(now_.load()); }
  void advance_to(Time t) { now_.store(std::max(now_.load(), t.count())); }

 private:
  std::atomic<std::int64_t> now_{0};
};

class Threads {
 public:
  Threads(const ThreadedOptions& options, const std::function<void(MemoryStream&)>& prepare)
      : options_(options),
        stream_(kDimensions, {.settle = 4, .stop_time = 10 * kInterval, .held_before_start = true},
                kRingCapacity, kBoardCapacity, {}, {}, kLive) {
    if (prepare) prepare(stream_);
  }

  ThreadedCounts run() {
    std::vector<std::thread> threads;
    threads.emplace_back([this] { solve(); });
    for (int i = 0; i < options_.readers; ++i) threads.emplace_back([this, i] { read(i); });
    for (int i = 0; i < options_.observers; ++i) threads.emplace_back([this, i] { observe(i); });
    produce();
    is_over_ = true;
    for (std::thread& thread : threads) thread.join();
    counts_.revisions = stream_.board.reader.revision();
    counts_.samples = samples_;
    counts_.busy = busy_;
    counts_.snapshots = snapshots_;
    counts_.observed = observed_;
    counts_.overwritten = overwritten_;
    counts_.torn_samples = torn_samples_;
    counts_.torn_snapshots = torn_snapshots_;
    counts_.torn_items = torn_items_;
    return counts_;
  }

 private:
  /// A waypoint with memory of its own, as the ring's item of this number.
  struct Payload {
    Values position, velocity;
    Payload(Time t, Word item)
        : position(with(position_at(t))), velocity(with(static_cast<double>(item))) {}
  };

  [[nodiscard]] bool is_enough() const {
    return counts_.appended >= options_.items && samples_ >= options_.reads &&
           snapshots_ >= options_.reads && (options_.observers == 0 || observed_ >= options_.reads);
  }

  void produce() {
    std::mt19937_64 random(1);
    Time next = kLead;
    while (!is_enough()) {
      const auto known = solved();
      next = std::max(next, known.settled_until + kLead);
      if (random() % 16 == 0) {
        replace(known, random() % kMostReplacing, next);
        continue;
      }
      const Payload payload(next, stream_.ring.writer.head());
      const auto status = stream_.ring.writer.append(
          {.time = next, .position = payload.position, .velocity = payload.velocity}, known);
      if (status == ipc::AppendStatus::accepted) {
        ++counts_.appended;
        clock_.advance_to(next - kLead);
        next += kInterval;
      } else {
        std::this_thread::yield();
      }
    }
  }

  /// What the producer knows of the solver.
  ipc::WaypointRingWriter::Solved solved() {
    const Word consumed = stream_.board.reader.tail();
    return {.consumed = consumed, .settled_until = stream_.board.reader.look().settled_until};
  }

  void replace(const ipc::WaypointRingWriter::Solved& known, std::size_t count, Time& next) {
    const Time from = std::max(known.settled_until, clock_.now()) + 2 * kLive.freeze_ahead;
    std::vector<Payload> payloads;
    std::vector<core::Waypoint> waypoints;
    payloads.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const Time t = from + kLive.freeze_ahead + kInterval * static_cast<std::int64_t>(i);
      payloads.emplace_back(t, stream_.ring.writer.head() + 1 + i);
      waypoints.push_back(
          {.time = t, .position = payloads[i].position, .velocity = payloads[i].velocity});
    }
    const auto status = stream_.ring.writer.replace_from(from, waypoints, known);
    if (status != ipc::AppendStatus::accepted) return std::this_thread::yield();
    ++counts_.replacements;
    next = stream_.ring.writer.last_time() + kInterval;
  }

  void solve() {
    for (std::uint64_t step = 1; !is_over_; ++step) {
      if (stream_.solver.step(clock_).consumed == 0) std::this_thread::yield();
      if (step % 100 != 0) continue;
      stream_.replace_solver();
      ++counts_.takeovers;
    }
  }

  void read(int seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    ipc::Sampler sampler(stream_.board.reader, ipc::StreamClock::monotonic);
    core::State state(kDimensions);
    ipc::Snapshot snapshot(kDimensions);
    for (std::uint64_t round = 1; !is_over_; ++round) {
      if (round % kBurst == 0) std::this_thread::yield();
      const Time now = clock_.now();
      const Time near = now + kInterval * (static_cast<std::int64_t>(random() % 60) - 30);
      const auto status =
          random() % 2 == 0 ? sampler.sample(now, state.ref()) : sampler.preview(near, state.ref());
      if (status == ipc::SampleStatus::busy) ++busy_;
      if (ipc::has_values(status)) {
        ++samples_;
        if (!is_whole(state.position()) || !is_whole(state.velocity()) ||
            !is_whole(state.acceleration()) || !is_whole(state.jerk())) {
          ++torn_samples_;
        }
      }
      if (random() % 8 == 0) take_snapshot(sampler, now, snapshot);
    }
  }

  /// One revision's segments must follow each other without a gap.
  void take_snapshot(ipc::Sampler& sampler, Time now, ipc::Snapshot& snapshot) {
    (void)sampler.snapshot(now - 5 * kInterval, now + 30 * kInterval, snapshot);
    const auto segments = snapshot.segments();
    if (segments.empty()) return;
    ++snapshots_;
    bool whole = true;
    for (std::size_t i = 0; i < segments.size(); ++i) {
      whole = whole && (i == 0 || segments[i].left == segments[i - 1].right);
      const auto powers = static_cast<std::size_t>(segments[i].order);
      for (std::size_t power = 0; power < powers; ++power) {
        whole =
            whole &&
            is_whole(std::span(segments[i].coefficients).subspan(power * kDimensions, kDimensions));
      }
    }
    if (!whole) ++torn_snapshots_;
  }

  void observe(int seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const ipc::WaypointRingReader& ring = stream_.ring.reader;
    ipc::RingItem item(kDimensions);
    for (std::uint64_t round = 1; !is_over_; ++round) {
      if (round % kBurst == 0) std::this_thread::yield();
      const Word head = ring.head();
      if (head < kRingCapacity) continue;
      // The oldest ones are those that the producer comes to next.
      const Word i = head - kRingCapacity + random() % kMostReplacing;
      if (!ring.observe(i, item)) {
        ++overwritten_;
        continue;
      }
      if (item.kind != ipc::ItemKind::waypoint) continue;
      ++observed_;
      const auto values = std::span<const double>(item.values);
      const bool whole =
          std::ranges::equal(values.first(kDimensions), with(position_at(item.time))) &&
          std::ranges::equal(values.subspan(kDimensions, kDimensions),
                             with(static_cast<double>(i)));
      if (!whole) ++torn_items_;
    }
  }

  ThreadedOptions options_;
  MemoryStream stream_;
  AtomicClock clock_;
  ThreadedCounts counts_;
  std::atomic<bool> is_over_{false};
  std::atomic<std::uint64_t> samples_{0}, busy_{0}, snapshots_{0}, observed_{0}, overwritten_{0};
  std::atomic<std::uint64_t> torn_samples_{0}, torn_snapshots_{0}, torn_items_{0};
};

}  // namespace

ThreadedCounts run_threads(const ThreadedOptions& options,
                           const std::function<void(MemoryStream&)>& prepare) {
  return Threads(options, prepare).run();
}

}  // namespace splinecast::testing
