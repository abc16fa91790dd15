#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "core/polynomial/segment.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/options.hpp"
#include "tests/campaign/kills/journal.hpp"
#include "tests/campaign/kills/payload.hpp"
#include "tests/fixtures/processes/patience.hpp"

namespace splinecast::campaign {

/// Timeout of each expected event; afterwards it counts as a hang.
using testing::kPatience;

/// A stream to attack; all of its processes know it.
struct Plan {
  std::string stream;
  StreamClock clock = StreamClock::recorded;
  Payload payload;
  /// Number of waypoints of a recorded stream, which is then finished and recreated.
  ipc::Word life = std::numeric_limits<ipc::Word>::max();
  Time pace{};  ///< real time from one append to the next; 0: no pause
  std::size_t ring_capacity = 64;
  std::size_t board_capacity = 2048;
  std::size_t readers = 2;
  Time tick{1'000'000};  ///< period of the readers; 0: no pause
  /// Reference for the segments of a recorded stream at its end; empty: not compared.
  std::vector<core::Segment> reference{};

  [[nodiscard]] bool is_live() const noexcept { return clock == StreamClock::monotonic; }
  [[nodiscard]] ProducerOptions producer_options() const;
  [[nodiscard]] SolverOptions solver_options() const;
};

/// A recorded stream of `life` waypoints, with its reference.
[[nodiscard]] Plan recorded_plan(std::string stream, ipc::Word life);

/// An endless recorded stream at full speed, with the smallest ring and board.
[[nodiscard]] Plan stress_plan(std::string stream, std::size_t readers);

/// A live stream that starts 200 ms from now.
[[nodiscard]] Plan live_plan(std::string stream);

/// The end condition of all streams: full stop.
[[nodiscard]] Condition end_condition();

}  // namespace splinecast::campaign
