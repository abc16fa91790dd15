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

namespace splinecast::campaign {

/// How long anything that must happen may take on a busy machine before it counts as hung.
inline constexpr Time kPatience{30'000'000'000};

/// A stream to be attacked, known to all of its processes.
struct Plan {
  std::string stream;
  StreamClock clock = StreamClock::recorded;
  Payload payload;
  /// Waypoints of a recorded stream, which is then finished and made anew.
  ipc::Word life = std::numeric_limits<ipc::Word>::max();
  Time pace{};  ///< real time from one append to the next; 0 for as fast as it goes
  std::size_t ring_capacity = 64;
  std::size_t board_capacity = 2048;
  std::size_t readers = 2;
  Time tick{1'000'000};  ///< of the readers; 0 for as fast as they can
  /// The segments that a recorded stream ends with; none to compare with if empty.
  std::vector<core::Segment> reference{};

  [[nodiscard]] bool is_live() const noexcept { return clock == StreamClock::monotonic; }
  [[nodiscard]] ProducerOptions producer_options() const;
  [[nodiscard]] SolverOptions solver_options() const;
};

/// A recorded stream of `life` waypoints, and the segments that it must end with.
[[nodiscard]] Plan recorded_plan(std::string stream, ipc::Word life);

/// A recorded stream without end, as fast as it goes, on a ring and a board as small as may be.
[[nodiscard]] Plan stress_plan(std::string stream, std::size_t readers);

/// A live stream from soon on.
[[nodiscard]] Plan live_plan(std::string stream);

/// The condition that streams end with: at rest.
[[nodiscard]] Condition end_condition();

}  // namespace splinecast::campaign
