// Producer and solver in one thread: streams the pose of a tool that turns on a circle, and solves
// the stream itself.
//
//   3_embedded_solver [STREAM]      default: arm
//
// Needs no other process. 6_horizon reads the motion, if it is started before or meanwhile.

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include <splinecast/clock.hpp>
#include <splinecast/errors.hpp>
#include <splinecast/producer.hpp>
#include <splinecast/solver.hpp>
#include <splinecast/streams.hpp>

using namespace splinecast;
using namespace std::chrono_literals;

namespace {

constexpr Time kDuration = 2s;
constexpr Time kInterval = 10ms;
constexpr Time kLead = 200ms;

/// x, y and orientation (x y z w) at a time of the motion: once around, from rest to rest.
std::array<double, 6> pose(Time t) {
  const double u = to_seconds(t) / to_seconds(kDuration);
  const double angle = 2 * std::numbers::pi * u * u * u * (10 - 15 * u + 6 * u * u);
  return {0.3 * std::cos(angle), 0.3 * std::sin(angle), 0, 0,
          std::sin(angle / 2),   std::cos(angle / 2)};
}

/// Steps whenever the solver has work, until `end`.
void solve_until(Solver& solver, const Clock& clock, Time end) {
  while (clock.now() < end) {
    while (solver.step(clock).consumed > 0) {
    }
    solver.wait(end - clock.now());  // returns when the solver is due
  }
}

void stream_pose(const char* stream) {
  constexpr Dimension kTurns{.kind = DimensionKind::quaternion};
  Producer producer(stream, {.dimensions = 6,
                             .names = {"x", "y", "qx", "qy", "qz", "qw"},
                             .units = {"m", "m", "", "", "", ""},
                             .kinds = {{}, {}, kTurns, kTurns, kTurns, kTurns}});
  // One limit per dimension: m/s; and for the quaternion, in its first dimension, rad/s.
  Solver solver(stream, {.limits = MotionLimits{.velocity = {2, 2, 7, 0, 0, 0}}});
  const MonotonicClock clock;
  while (!solver.attach(clock)) solver.wait(50ms);  // an earlier curve of that name may still move

  const Time begin = clock.now() + kLead;
  for (Time t{}; t <= kDuration; t += kInterval) {
    solve_until(solver, clock, begin + t - kLead);
    const auto position = pose(t);
    const AppendStatus status = producer.append({.time = begin + t, .position = position});
    if (status != AppendStatus::accepted && status != AppendStatus::past) {
      throw StreamError(std::string(to_string(status)));  // past: this process was held up
    }
  }
  (void)producer.finish();
  solve_until(solver, clock, begin + kDuration + 50ms);  // readers follow the curve to its end

  const auto refused = producer.refusals();
  std::printf("%llu of %llu items consumed, %zu refused\n",
              static_cast<unsigned long long>(producer.consumed()),
              static_cast<unsigned long long>(producer.appended()), refused.items.size());
}

}  // namespace

int main(int argc, char** argv) {
  const char* const stream = argc > 1 ? argv[1] : "arm";
  try {
    stream_pose(stream);
    remove_stream(stream);  // its writers are destroyed; readers get `retired`
  } catch (const StreamError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
