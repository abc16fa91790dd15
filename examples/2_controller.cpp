// Samples a live stream at each revision of its curve and prints the position of its first
// dimension.
//
//   2_controller [STREAM]    default: arm
//
// Needs a producer and a solver: 1_producer or `splinecast replay`, and splinecast solve STREAM.
// Start it before or after them. It ends after 1000 samples, or if there is no revision for 1 s.

#include <cstdio>

#include <splinecast/clock.hpp>
#include <splinecast/reader.hpp>

int main(int argc, char** argv) {
  using namespace std::chrono_literals;
  splinecast::Reader reader(argc > 1 ? argv[1] : "arm", 10s);  // waits up to 10 s for the stream
  splinecast::State state(reader.dimensions());
  const splinecast::MonotonicClock clock;
  for (int tick = 0; tick < 1000; ++tick) {
    const auto status = reader.sample(clock.now(), state);  // wait-free
    if (splinecast::has_values(status)) std::printf("%g\n", state.position()[0]);
    if (reader.wait(1s) != splinecast::WaitStatus::advanced) break;  // or your own 1 kHz tick
  }
}
