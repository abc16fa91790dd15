#pragma once

#include <cstdint>
#include <vector>

#include "core/online/sliding_window.hpp"
#include "ipc/solve/stream_solver.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/options.hpp"
#include "tests/campaign/streams/random.hpp"

namespace splinecast::campaign {

/// Acceleration limits of a stream compared with its motion's accelerations.
enum class LimitClass : std::uint8_t { none, generous, tight };
inline constexpr std::size_t kLimitClasses = 3;

/// The random parameters of one simulated live stream.
struct StreamPlan {
  std::uint64_t seed = 0;
  std::vector<Dimension> dimensions{};
  DimensionKinds kinds{};
  core::WindowOptions window{};
  LimitClass limit_class = LimitClass::none;
  ipc::LiveOptions live{};
  ipc::IntervalRange ingest{};
  std::size_t ring_capacity = 0;
  std::size_t board_capacity = 0;
  Time begin{};             ///< clock reading at the creation of the stream
  Time interval{};          ///< between two waypoints
  Time length{};            ///< time until its producer finishes
  Time tick{};              ///< period of the controller
  double frequency = 0;     ///< of the motion, rad/s
  double magnitude = 1;     ///< of positions
  double offset = 0;        ///< of positions, in magnitudes
  double step_trouble = 0;  ///< share of the solver's steps with a fault
  bool starts_in_motion = false;
  Beyond beyond{};
  Condition end{};  ///< end condition
};

/// The plan of a seed. `random` has the same seed.
[[nodiscard]] StreamPlan make_plan(std::uint64_t seed, Random& random);

}  // namespace splinecast::campaign
