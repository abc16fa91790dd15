// A motion that an operator slows down, holds and resumes: the stream follows a time law, and this
// program is its producer, the operator's panel and a controller.
//
//   10_override [STREAM]      default: arm
//
// Needs a solver of both: splinecast solve STREAM STREAM.law

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <thread>

#include <splinecast/clock.hpp>
#include <splinecast/errors.hpp>
#include <splinecast/producer.hpp>
#include <splinecast/rate_commander.hpp>
#include <splinecast/reader.hpp>

using namespace splinecast;
using namespace std::chrono_literals;

namespace {

constexpr Time kDuration = 2s;  // of stream time
constexpr Time kInterval = 10ms;
constexpr Time kLead = 300ms;  // of stream time
constexpr double kRadius = 0.3;

/// Once around a circle, from rest to rest.
std::array<double, 2> place(Time t) {
  const double u = to_seconds(t) / to_seconds(kDuration);
  const double angle = 2 * std::numbers::pi * u * u * u * (10 - 15 * u + 6 * u * u);
  return {kRadius * std::cos(angle), kRadius * std::sin(angle)};
}

/// What the operator does, by the time since the beginning.
struct Request {
  Time time;
  double rate;
};
constexpr std::array kRequests{Request{1000ms, 0.3}, Request{1500ms, 0}, Request{2000ms, 1}};

/// Appends the waypoints whose time is within the lead. The ring has room for all of them.
void produce(Producer& producer, Time begin, Time& next) {
  for (; next <= kDuration && begin + next <= producer.now() + kLead; next += kInterval) {
    const auto position = place(next);
    if (producer.append({.time = begin + next, .position = position}) != AppendStatus::accepted) {
      std::printf("the waypoint at %g s is late\n", to_seconds(next));
    }
    if (next == kDuration) (void)producer.finish();
  }
}

void run(const std::string& stream) {
  const std::string law = stream + ".law";
  RateCommander panel(law, "panel");
  panel.set_rate(1, 100ms);
  Reader(law, 10s);  // waits until a solver has created the law
  Producer producer(stream, {.dimensions = 2, .clock = StreamClock::law, .law = law});
  if (!producer.wait_for_solver(10s)) throw StreamError("no solver: splinecast solve " + stream);
  const Time begin = producer.now() + kLead;  // stream time
  Time next{};
  produce(producer, begin, next);

  Reader reader(stream, 10s);
  State state(reader.dimensions());
  const MonotonicClock clock;
  const Time start = clock.now();
  auto request = kRequests.begin();
  double farthest = 0;
  for (Time t = start; reader.rate().stream_time < begin + kDuration; t += 1ms) {
    std::this_thread::sleep_until(std::chrono::steady_clock::time_point(t));  // CLOCK_MONOTONIC
    produce(producer, begin, next);
    if (request != kRequests.end() && t >= start + request->time) {
      panel.set_rate(request->rate, 200ms);
      std::printf("requested rate %g\n", request->rate);
      ++request;
    }
    if (!has_values(reader.sample(t, state))) continue;  // t is host time
    const auto position = state.position();
    farthest = std::max(farthest, std::abs(std::hypot(position[0], position[1]) - kRadius));
  }
  const Time lag = (clock.now() - start) - (kDuration + kLead);
  std::printf("at most %.2g mm from the circle; %.1f s longer than at full rate\n", 1e3 * farthest,
              to_seconds(lag));
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
