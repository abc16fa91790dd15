// Appends the waypoints of a live motion, a circle of 2 s at 100 Hz, each 200 ms before its time.
//
//   1_producer [STREAM] [--law LAW]      default: arm, without a time law
//
// Needs a solver in a process of its own: splinecast solve STREAM. 2_controller reads the motion.
// With a law: splinecast solve STREAM LAW, and splinecast rate LAW 1.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <string_view>
#include <thread>

#include <splinecast/errors.hpp>
#include <splinecast/producer.hpp>

using namespace splinecast;
using namespace std::chrono_literals;

namespace {

constexpr Time kDuration = 2s;
constexpr Time kInterval = 10ms;
constexpr Time kLead = 200ms;  // at least freeze-ahead (5 ms) and K + 1 (9) intervals

/// The position at a time of the motion: once around a circle, from rest to rest.
std::array<double, 2> circle(Time t) {
  const double u = to_seconds(t) / to_seconds(kDuration);
  const double angle = 2 * std::numbers::pi * u * u * u * (10 - 15 * u + 6 * u * u);
  return {0.3 * std::cos(angle), 0.3 * std::sin(angle)};
}

/// Waits until the stream's clock shows a time. The clock of a time law may be slow, or held.
void wait_until(Producer& producer, Time t) {
  for (Time now = producer.now(); now < t; now = producer.now()) {
    std::this_thread::sleep_for(std::min<Time>(t - now, 5ms));
  }
}

/// Appends a waypoint. Waits for the solver while the ring is full.
AppendStatus send(Producer& producer, const Waypoint& waypoint) {
  AppendStatus status = producer.append(waypoint);
  while (status == AppendStatus::full && producer.wait_for_room(1s)) {
    status = producer.append(waypoint);
  }
  return status;  // full: the solver has consumed nothing for 1 s
}

int produce(const char* stream, const std::string& law) {
  const StreamClock clock = law.empty() ? StreamClock::monotonic : StreamClock::law;
  Producer producer(
      stream,
      {.dimensions = 2, .names = {"x", "y"}, .units = {"m", "m"}, .clock = clock, .law = law});
  if (!producer.wait_for_solver(10s)) {
    std::fprintf(stderr, "no solver: splinecast solve %s\n", stream);
    return 1;
  }
  const Time begin = producer.now() + kLead;  // times count from now, not from earlier
  int late = 0;
  for (Time t{}; t <= kDuration; t += kInterval) {
    wait_until(producer, begin + t - kLead);
    const auto position = circle(t);
    const AppendStatus status = send(producer, {.time = begin + t, .position = position});
    if (status == AppendStatus::past) {
      ++late;  // this process was held up: the motion continues with the next waypoint
    } else if (status != AppendStatus::accepted) {
      std::fprintf(stderr, "waypoint refused: %s\n", std::string(to_string(status)).c_str());
      return 1;
    }
  }
  if (producer.finish() != AppendStatus::accepted) return 1;
  if (!producer.wait_until_consumed(10s)) return 1;
  const auto sent = static_cast<unsigned long long>(producer.appended() - 1);  // without the finish
  std::printf("%llu waypoints sent, %d late, %zu refused\n", sent, late,
              producer.refusals().items.size());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const char* stream = "arm";
  const char* law = "";
  for (int i = 1; i < argc; ++i) {
    const bool is_law = std::string_view(argv[i]) == "--law" && i + 1 < argc;
    (is_law ? law : stream) = argv[is_law ? ++i : i];
  }
  try {
    return produce(stream, law);
  } catch (const StreamError& error) {  // another producer lives, shared memory is full, …
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
