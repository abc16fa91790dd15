// Follows a live stream at 1 kHz and prints the position of its first dimension every 10 ms.
//
//   2_controller [STREAM]    default: arm
//
// Needs a producer and a solver: 1_producer or `splinecast replay`, and splinecast solve STREAM.
// Start it before or after them. It ends where a finished stream rests. If the stream is removed
// and created again, it follows the new one only from where the machine is.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <thread>

#include <splinecast/clock.hpp>
#include <splinecast/reader.hpp>

using namespace std::chrono_literals;
using splinecast::SampleStatus;

constexpr double kNear = 0.001;  // of a unit of the stream

bool is_near(const splinecast::State& a, const splinecast::State& b) {
  if (a.position().size() != b.position().size()) return false;
  for (std::size_t d = 0; d < a.position().size(); ++d) {
    if (std::abs(a.position()[d] - b.position()[d]) > kNear) return false;
  }
  return true;
}

int main(int argc, char** argv) try {
  const std::string stream = argc > 1 ? argv[1] : "arm";
  splinecast::Reader reader(stream, 10s);  // waits up to 10 s for the stream
  splinecast::State state(reader.dimensions());
  splinecast::State target = state;  // of the machine
  bool is_new = false;
  const splinecast::MonotonicClock clock;
  splinecast::Time due = clock.now();
  for (int tick = 0;; ++tick) {
    due = std::max(due + 1ms, clock.now());
    std::this_thread::sleep_until(std::chrono::steady_clock::time_point(due));  // CLOCK_MONOTONIC
    const auto now = clock.now();
    const auto status = reader.sample(now, state);  // wait-free
    if (status == SampleStatus::retired) {          // the stream was removed: the machine stays
      reader = splinecast::Reader(stream, 10s);
      state = splinecast::State(reader.dimensions());
      is_new = true;
    }
    if (!splinecast::has_values(status)) continue;
    if (is_new && !is_near(state, target)) throw std::runtime_error(stream + " begins elsewhere");
    is_new = false;
    target = state;  // your machine moves to target.position()
    if (tick % 10 == 0) std::printf("%g\n", target.position()[0]);
    if (status != SampleStatus::holding) continue;
    const auto progress = reader.progress();
    if (progress && progress->is_finished && now > progress->newest) break;
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
