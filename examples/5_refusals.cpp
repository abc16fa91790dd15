// Accepted or refused: sends 3,000 measured orientations on a recorded stream as fast as possible.
// One is sent twice, which `append` refuses; some are zeros, which only the solver refuses.
//
//   5_refusals [STREAM]      default: arm
//
// Needs a solver in a process of its own: splinecast solve STREAM.

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>

#include <splinecast/errors.hpp>
#include <splinecast/producer.hpp>

using namespace splinecast;
using namespace std::chrono_literals;

namespace {

/// An orientation (x y z w); of length 0, which is not a rotation, where the sensor had no fix.
std::array<double, 4> orientation(int row) {
  if (row % 1000 == 500) return {0, 0, 0, 0};
  return {0, 0, std::sin(0.001 * row), std::cos(0.001 * row)};
}

AppendStatus send(Producer& producer, const Waypoint& waypoint) {
  AppendStatus status = producer.append(waypoint);
  while (status == AppendStatus::full && producer.wait_for_room(1s)) {
    status = producer.append(waypoint);
  }
  return status;
}

/// Prints what the solver has refused since the last call, by item number, time and reason.
void print_refusals(Producer& producer) {
  const Refusals refused = producer.refusals();
  for (const ItemRefusal& refusal : refused.items) std::puts(to_string(refusal).c_str());
  if (refused.missed > 0) std::puts("older refusals are missing: call refusals() more often");
}

void run(const char* stream) {
  const Dimension turn{.kind = DimensionKind::quaternion};
  Producer producer(stream, {.dimensions = 4,
                             .names = {"qx", "qy", "qz", "qw"},
                             .kinds = {turn, turn, turn, turn},
                             .clock = StreamClock::recorded});
  if (!producer.wait_for_solver(10s)) throw StreamError("no solver");
  for (int row = 0; row < 3000; ++row) {
    const auto q = orientation(row);
    const Waypoint waypoint{.time = row * 10ms, .position = q};
    AppendStatus status = send(producer, waypoint);
    if (status != AppendStatus::accepted) throw StreamError(std::string(to_string(status)));
    if (row == 1234) {
      status = send(producer, waypoint);  // changes nothing: the stream continues
      std::printf("row %d again: %s\n", row, std::string(to_string(status)).c_str());
    }
    if (row % 500 == 499) print_refusals(producer);  // at least once per 1,024 waypoints
  }

  (void)producer.finish();
  (void)producer.wait_until_consumed(10s);
  for (const ItemRefusal& refusal : producer.refusals().items)
    std::puts(to_string(refusal).c_str());
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc > 1 ? argv[1] : "arm");
  } catch (const StreamError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
