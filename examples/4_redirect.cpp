// Leaves the curve for a new path while the machine moves, and stops it: a line along x, then back
// to the start, then a stop.
//
//   4_redirect [STREAM]      default: arm
//
// Needs a solver in a process of its own: splinecast solve STREAM.

#include <chrono>
#include <cstdio>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <splinecast/clock.hpp>
#include <splinecast/errors.hpp>
#include <splinecast/producer.hpp>
#include <splinecast/reader.hpp>

using namespace splinecast;
using namespace std::chrono_literals;

namespace {

/// Leaves the curve 10 ms after the earliest time, for `path`, whose times count from there; an
/// empty one stops it.
AppendStatus redirect(Producer& producer, std::vector<Waypoint> path) {
  const Time t = producer.earliest() + 10ms;
  for (Waypoint& waypoint : path) waypoint.time += t;
  return producer.replace_from(t, path);  // too_late: t has settled meanwhile, try again
}

/// Comes to rest as soon as possible.
AppendStatus stop(Producer& producer) { return producer.replace_from({}); }

/// Prints what `redirect` would do now with at least this duration of the entry. Changes nothing.
void print_preview(Producer& producer, std::vector<Waypoint> path, Time blend) {
  const Time t = producer.earliest() + 10ms;
  for (Waypoint& waypoint : path) waypoint.time += t;
  const ReplacePreview preview = producer.preview_replace(t, path, {.blend = blend});
  if (preview.status != AppendStatus::accepted || !preview.is_known) return;
  std::printf("entry of %.0f ms: at most %.2f m/s, %.2f m/s^2; %zu waypoints passed over\n",
              1e3 * to_seconds(preview.duration), preview.entry.velocity[0],
              preview.entry.acceleration[0], preview.passed_over);
}

/// 101 positions of a motion from rest to rest.
std::vector<double> motion(double begin, double end) {
  std::vector<double> x;
  for (int i = 0; i <= 100; ++i) {
    const double u = i / 100.0;
    x.push_back(begin + (end - begin) * u * u * u * (10 - 15 * u + 6 * u * u));
  }
  return x;
}

/// A waypoint every 20 ms for each position. Refers to `x`, which must outlive it.
std::vector<Waypoint> waypoints_at(std::span<const double> x, Time begin) {
  std::vector<Waypoint> path;
  for (std::size_t i = 0; i < x.size(); ++i) {
    path.push_back({.time = begin + static_cast<int>(i) * 20ms, .position = x.subspan(i, 1)});
  }
  return path;
}

/// Prints the outcome of the last item, and where the machine is.
void show(const char* what, Producer& producer, Reader& reader) {
  const ItemOutcome outcome = producer.wait_outcome(producer.last_item(), 1s);
  State state(1);
  if (!has_values(reader.sample(MonotonicClock().now(), state))) return;
  std::printf("%s %s; now at x = %.3f m, v = %.3f m/s\n", what, to_string(outcome).c_str(),
              state.position()[0], state.velocity()[0]);
}

void run(const char* stream) {
  Producer producer(stream, {.dimensions = 1, .names = {"x"}, .units = {"m"}});
  if (!producer.wait_for_solver(10s)) throw StreamError("no solver");
  Reader reader(stream, 1s);  // only to show what a controller sees

  const Time begin = MonotonicClock().now() + 200ms;
  const std::vector<double> forth = motion(0, 1);
  for (const Waypoint& waypoint : waypoints_at(forth, begin)) {
    if (producer.append(waypoint) != AppendStatus::accepted) throw StreamError("refused");
  }

  std::this_thread::sleep_for(800ms);
  const std::vector<double> back = motion(0.3, 0);
  const std::vector<Waypoint> path = waypoints_at(back, 300ms);
  print_preview(producer, path, 0ms);
  print_preview(producer, path, 500ms);
  AppendStatus status = redirect(producer, path);
  while (status == AppendStatus::too_late) status = redirect(producer, path);
  if (status != AppendStatus::accepted) throw StreamError("redirect refused");
  show("redirect", producer, reader);

  std::this_thread::sleep_for(800ms);
  if (stop(producer) != AppendStatus::accepted) throw StreamError("stop refused");
  show("stop", producer, reader);

  State state(1);
  const MonotonicClock clock;
  while (reader.sample(clock.now(), state) != SampleStatus::holding) (void)reader.wait(10ms);
  std::printf("at rest at x = %.3f m\n", state.position()[0]);
  if (producer.finish() != AppendStatus::accepted) {
    throw StreamError("finish refused");
  }
  if (!producer.wait_until_consumed(10s)) throw StreamError("not consumed");
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
