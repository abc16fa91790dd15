#include "bench/harness/law_stream.hpp"

#include <chrono>
#include <stdexcept>

#include "splinecast/reader.hpp"

namespace splinecast::bench {
namespace {

constexpr Time kStep = std::chrono::milliseconds(5);
constexpr Time kRamp = std::chrono::milliseconds(5);
constexpr Time kDay = std::chrono::hours(24);

}  // namespace

LawStream::LawStream(const Waypoints& waypoints)
    : commander_(law_, "bench"),
      law_solver_(law_, {.history = kDay}),
      solver_(name_, {.history = kDay, .capacity = waypoints.times.size() + 64}) {
  commander_.set_rate(kRate, kRamp);
  if (!law_solver_.attach(clock_)) throw std::runtime_error("the law has no solver");
  pass(10 * kStep);
  pass_waypoints(waypoints);
  // A later revision of the law settles it until then.
  commander_.set_rate(1, kRamp);
  pass(10 * kStep);
}

void LawStream::pass(Time time) {
  for (const Time end = clock_.now() + time; clock_.now() < end;) {
    clock_.advance(kStep);
    (void)law_solver_.step(clock_);
    if (solver_.attached()) (void)solver_.step(clock_);
  }
}

void LawStream::pass_waypoints(const Waypoints& waypoints) {
  Producer producer(name_, {.dimensions = waypoints.dimensions,
                            .clock = StreamClock::law,
                            .law = law_,
                            .capacity = 8192});
  if (!solver_.attach(clock_)) throw std::runtime_error("the stream has no solver");
  const Time lead = std::chrono::milliseconds(500);
  const Time first = producer.now() + lead;
  for (std::size_t i = 0; i < waypoints.times.size(); ++i) {
    const Waypoint waypoint{.time = first + waypoints.times[i], .position = waypoints.position(i)};
    const AppendStatus status = producer.append(waypoint);
    if (status != AppendStatus::accepted) throw std::runtime_error(std::string(to_string(status)));
  }
  (void)producer.finish({.kind = ConditionKind::halt, .value = {}});
  pass(kStep);
  Reader reader(name_);
  State state(waypoints.dimensions);
  const auto stream_now = [&] {
    (void)reader.preview(clock_.now(), state);
    return reader.rate().stream_time;
  };
  while (stream_now() < first) pass(kStep);
  begin_ = clock_.now();
  while (stream_now() < first + waypoints.times.back()) pass(kStep);
  end_ = clock_.now() - kStep;
}

}  // namespace splinecast::bench
