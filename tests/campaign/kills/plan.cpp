#include "tests/campaign/kills/plan.hpp"

#include <chrono>
#include <utility>

#include "tests/fixtures/curves/online.hpp"

namespace splinecast::campaign {
namespace {

using std::chrono::milliseconds;

Condition start_condition(StreamClock clock) {
  const bool is_live = clock == StreamClock::monotonic;
  return {.kind = is_live ? ConditionKind::halt : ConditionKind::natural, .value = {}};
}

Payload rough_payload() { return {Time::zero(), milliseconds(10), Payload::Shape::rough}; }

/// The segments of an undisturbed solve of the stream.
std::vector<core::Segment> solve(const Payload& payload, ipc::Word life) {
  std::vector<Time> times;
  std::vector<double> positions;
  for (ipc::Word n = 0; n < life; ++n) {
    times.push_back(payload.time_of(n));
    const Payload::Row row = payload.position_of(n);
    positions.insert(positions.end(), row.begin(), row.end());
  }
  return testing::settled_segments(
      {.dimensions = Payload::kDimensions, .times = times, .positions = positions},
      {.start = start_condition(StreamClock::recorded)}, end_condition());
}

}  // namespace

Condition end_condition() { return {.kind = ConditionKind::halt, .value = {}}; }

ProducerOptions Plan::producer_options() const {
  return {.dimensions = Payload::kDimensions,
          .clock = clock,
          .start = start_condition(clock),
          .capacity = ring_capacity};
}

SolverOptions Plan::solver_options() const { return {.capacity = board_capacity}; }

Plan recorded_plan(std::string stream, ipc::Word life) {
  const Payload payload = rough_payload();
  return {.stream = std::move(stream),
          .payload = payload,
          .life = life,
          .pace = std::chrono::microseconds(500),
          .reference = solve(payload, life)};
}

Plan stress_plan(std::string stream, std::size_t readers) {
  return {.stream = std::move(stream),
          .payload = rough_payload(),
          .ring_capacity = 16,
          .board_capacity = 32,
          .readers = readers,
          .tick = Time::zero()};
}

Plan live_plan(std::string stream) {
  const Time start = MonotonicClock().now() + milliseconds(200);
  return {.stream = std::move(stream),
          .clock = StreamClock::monotonic,
          .payload = Payload(start, milliseconds(2), Payload::Shape::smooth),
          .pace = milliseconds(1)};
}

}  // namespace splinecast::campaign
