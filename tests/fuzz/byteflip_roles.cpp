#include "tests/fuzz/byteflip_roles.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <random>
#include <vector>

#include "apps/streams/report.hpp"
#include "ipc/roles/inspect.hpp"
#include "ipc/roles/internals.hpp"
#include "ipc/sampling/snapshot.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::fuzz {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kDimensions = 5;
constexpr std::size_t kSegments = 256;
constexpr Time kLead = 50ms;

/// Sleeps for 1 ms.
void rest() { poll(nullptr, 0, 1); }

ProducerOptions producer_options() {
  ProducerOptions options{.dimensions = kDimensions, .capacity = 64};
  options.kinds.assign(kDimensions, {.kind = DimensionKind::quaternion});
  options.kinds[0] = {.kind = DimensionKind::periodic, .period = 6};
  return options;
}

/// A reader that samples a stream at random times.
class FlipReader {
 public:
  FlipReader(const std::string& stream, std::uint64_t seed, FlipCounters& counters)
      : stream_(stream), random_(seed), counters_(&counters) {}

  void attach_and_read() {
    Reader reader(stream_);
    ++counters_->attached;
    State state(reader.dimensions());
    ipc::BoardSnapshot snapshot(reader.dimensions());
    constexpr int kSamples = 2'000;
    for (int i = 0; i < kSamples && !counters_->stop; ++i) {
      const Time t =
          clock_.now() + Time(static_cast<std::int64_t>(random_() % 200'000'000) - 100'000'000);
      count(random_() % 2 == 0 ? reader.sample(clock_.now(), state) : reader.preview(t, state),
            state);
      if (i % 64 == 0) take_snapshot(reader, snapshot);
      if (i % 16 == 0) look_ahead(reader);
      if (i % 256 == 0) (void)reader.wait(1ms);
    }
    look();
  }

 private:
  void count(SampleStatus status, const State& state) {
    ++counters_->samples;
    if (!has_values(status)) return;
    ++counters_->with_values;
    const bool are_numbers =
        std::ranges::all_of(state.values(), [](double value) { return std::isfinite(value); });
    if (!are_numbers) ++counters_->not_numbers;
  }

  void look_ahead(Reader& reader) {
    std::array<Time, 16> times{};
    for (Time t = clock_.now() - kLead; Time & time : times) time = t += kLead / 4;
    std::array<SampleStatus, times.size()> statuses{};
    const std::size_t stride = reader.dimensions();
    std::vector<double> values(times.size() * stride);
    (void)ipc::Internals::sampler(reader).sample_many(
        times, {.values = values, .status = statuses, .derivatives = Derivatives::position});
    for (std::size_t i = 0; i < times.size(); ++i) {
      ++counters_->samples;
      if (!has_values(statuses[i])) continue;
      ++counters_->with_values;
      const auto at = std::span(values).subspan(i * stride, stride);
      const bool are_numbers =
          std::ranges::all_of(at, [](double value) { return std::isfinite(value); });
      if (!are_numbers) ++counters_->not_numbers;
    }
  }

  void take_snapshot(Reader& reader, ipc::BoardSnapshot& snapshot) {
    const Time now = clock_.now();
    ++counters_->snapshots;
    if (!has_values(ipc::Internals::sampler(reader).snapshot(now - kLead, now + kLead, snapshot)))
      return;
    for (const ipc::SegmentCopy& segment : snapshot.segments()) {
      const auto used = static_cast<std::size_t>(segment.order) * snapshot.dimensions();
      const auto values = std::span(segment.coefficients).first(used);
      if (!std::ranges::all_of(values, [](double value) { return std::isfinite(value); })) {
        ++counters_->not_numbers;
      }
    }
  }

  void look() {
    (void)apps::pretty(apps::to_json(ipc::inspect(stream_)));
    ++counters_->reports;
  }

  std::string stream_;
  std::mt19937_64 random_;
  FlipCounters* counters_;
  MonotonicClock clock_;
};

}  // namespace

bool produce_until_stopped(const std::string& stream, FlipCounters& counters) {
  try {
    Producer producer(stream, producer_options());
    const MonotonicClock clock;
    std::vector<double> position(kDimensions);
    while (!counters.stop) {
      const Time t = clock.now() + kLead;
      for (std::size_t d = 0; d < kDimensions; ++d) {
        position[d] = std::sin(to_seconds(t) * static_cast<double>(1 + d));
      }
      if (producer.append({.time = t, .position = position}) == AppendStatus::accepted) {
        ++counters.appended;
      }
      rest();
    }
    return true;
  } catch (const StreamError&) {
    return false;
  }
}

bool solve_until_stopped(const std::string& stream, FlipCounters& counters) {
  try {
    Solver solver(stream, {.history = 50ms, .capacity = kSegments});
    const MonotonicClock clock;
    while (!counters.stop) {
      if (!solver.attach()) rest();
      if (solver.step(clock).published) ++counters.revisions;
      solver.wait(5ms);
    }
    return true;
  } catch (const StreamError&) {
    return false;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

bool read_until_stopped(const std::string& stream, std::uint64_t seed, FlipCounters& counters) {
  FlipReader reader(stream, seed, counters);
  while (!counters.stop) {
    try {
      reader.attach_and_read();
    } catch (const NoSuchStream&) {
      rest();
    } catch (const StreamError&) {
      ++counters.refused;
      rest();
    }
  }
  return true;
}

}  // namespace splinecast::fuzz
