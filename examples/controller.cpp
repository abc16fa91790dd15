#include "splinecast/reader.hpp"

#include <cstdio>

int main(int argc, char** argv) {
  using namespace splinecast;
  using namespace std::chrono_literals;
  ipc::Reader reader(argc > 1 ? argv[1] : "arm", 10s);  // waits up to 10 s for the stream
  core::State state(reader.dimensions());
  const ipc::MonotonicClock clock;
  for (int tick = 0; tick < 1000; ++tick) {
    const ipc::SampleStatus status = reader.sample(clock.now(), state);  // wait-free
    if (ipc::has_values(status)) std::printf("%g\n", state.position()[0]);
    if (reader.wait(1s) != ipc::WaitStatus::advanced) break;  // or your own 1 kHz tick
  }
}
