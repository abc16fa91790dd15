#pragma once

#include <cstdint>
#include <vector>

#include "core/online/sliding_window.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/options.hpp"
#include "tests/campaign/streams/random.hpp"

namespace splinecast::campaign {

/// What acceleration limits a stream has, next to its motion's own accelerations.
enum class LimitClass : std::uint8_t { none, generous, tight };
inline constexpr std::size_t kLimitClasses = 3;

/// Everything that is fixed about one simulated live stream.
struct StreamPlan {
  std::uint64_t seed = 0;
  std::vector<Dimension> dimensions{};
  DimensionKinds kinds{};
  core::WindowOptions window{};
  LimitClass limit_class = LimitClass::none;
  ipc::LiveOptions live{};
  IngestLimits ingest{};
  std::size_t ring_capacity = 0;
  std::size_t board_capacity = 0;
  Time begin{};             ///< the clock when the stream is made
  Time interval{};          ///< between two waypoints
  Time length{};            ///< until its producer finishes
  Time tick{};              ///< of the controller
  double frequency = 0;     ///< of the motion, rad/s
  double magnitude = 1;     ///< of positions
  double offset = 0;        ///< of positions, in magnitudes
  double step_trouble = 0;  ///< share of the solver's steps in which something goes wrong
  bool starts_in_motion = false;
  Beyond beyond{};
  Condition end{};  ///< that it is finished with
};

/// The plan of a seed; `random` is of that seed, too.
[[nodiscard]] StreamPlan make_plan(std::uint64_t seed, Random& random);

}  // namespace splinecast::campaign
