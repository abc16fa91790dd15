// The horizon of a predictive controller: 100 times a second, 20 future states of one revision.
// Compares the last of them with the limits of the stream, and reads angular velocity.
//
//   6_horizon [STREAM]       default: arm
//
// Needs a stream in motion: 3_embedded_solver, or a producer and a solver. It ends with the
// motion, or after 1000 horizons.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include <splinecast/clock.hpp>
#include <splinecast/dimension_kind.hpp>
#include <splinecast/errors.hpp>
#include <splinecast/reader.hpp>
#include <splinecast/snapshot.hpp>

using namespace splinecast;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t kHorizon = 20;
constexpr Time kStep = 10ms;

/// |ω| of the first quaternion of a sample, in rad/s; 0 without one.
double turning(const DimensionKinds& kinds, const State& state) {
  if (kinds.quaternions().empty()) return 0;
  const AngularMotion turn = angular_motion(kinds.quaternions()[0], state.position(),
                                            state.velocity(), state.acceleration());
  return std::hypot(turn.velocity[0], turn.velocity[1], turn.velocity[2]);
}

bool has_ended(const Reader& reader, Time now) {
  const auto progress = reader.progress();
  return progress && progress->is_finished && now > progress->newest;
}

void print_excess(const Excess& worst) {
  if (worst.ratio < 0) return;  // no limits
  std::printf("nearest to a limit: %s of dimension %zu, %.3f of %g\n",
              std::string(to_string(worst.kind)).c_str(), worst.dimension, worst.value,
              worst.limit);
}

void follow(Reader& reader) {
  const std::size_t dimensions = reader.dimensions();
  const Derivatives wanted = Derivatives::position | Derivatives::velocity;
  std::array<Time, kHorizon> times{};
  std::array<SampleStatus, kHorizon> status{};
  std::vector<double> values(kHorizon * count(wanted) * dimensions);
  const SampleBlock block{.values = values, .status = status, .derivatives = wanted};
  State state(dimensions);
  const DimensionKinds kinds = reader.kinds();

  int horizons = 0;
  double speed = 0;
  double turn = 0;
  Excess worst;
  const MonotonicClock clock;
  for (Time now = clock.now(); horizons < 1000 && !has_ended(reader, now); now += kStep) {
    std::this_thread::sleep_until(std::chrono::steady_clock::time_point(now));  // CLOCK_MONOTONIC
    for (std::size_t i = 0; i < kHorizon; ++i) times[i] = now + static_cast<int>(i) * kStep;
    const std::uint64_t revision = reader.sample_many(times, block);
    if (status[0] == SampleStatus::retired) break;
    if (revision == 0) continue;  // no data yet, or busy: no status has values
    ++horizons;
    for (std::size_t i = 0; i < kHorizon; ++i) {
      if (!has_values(status[i])) continue;
      const double* const v = &values[(i * count(wanted) + 1) * dimensions];  // [time][velocity]
      speed = std::max(speed, std::abs(v[0]));
    }

    // The end of the horizon, with all derivatives: not executed, so never `revised` later.
    if (!has_values(reader.preview(times.back(), state))) continue;
    turn = std::max(turn, turning(kinds, state));
    const Excess excess = reader.excess(state);
    if (excess.ratio > worst.ratio) worst = excess;
  }
  std::printf("%d horizons of %zu states, |v[0]| at most %.3f, |omega| at most %.3f\n", horizons,
              kHorizon, speed, turn);
  print_excess(worst);
}

/// Prints the segments of the last 50 ms.
void print_segments(Reader& reader, Time now) {
  Snapshot snapshot(reader.dimensions());
  if (!has_values(reader.snapshot(now - 50ms, now, snapshot))) return;
  for (std::size_t i = 0; i < snapshot.size(); ++i) {
    const SnapshotSegment segment = snapshot[i];
    std::printf("segment of %.1f ms, order %d, begins at %g\n",
                1e3 * to_seconds(segment.right - segment.left), segment.order,
                segment.coefficients[0]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    Reader reader(argc > 1 ? argv[1] : "arm", 10s);
    follow(reader);
    print_segments(reader, MonotonicClock().now());
  } catch (const StreamError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
