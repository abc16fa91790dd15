#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "splinecast/boundary_condition.hpp"
#include "tests/campaign/ends/piece.hpp"
#include "tests/campaign/streams/plan.hpp"
#include "tests/campaign/streams/random.hpp"

namespace splinecast::campaign::ends {

/// How a life ends.
enum class Ending : std::uint8_t {
  finish,            ///< by a finish
  stop,              ///< by a requested stop, and nothing else
  stop_then_finish,  ///< by both, as a signal ends a replay
  cancel,            ///< by a replacement of its motion, and a finish
  killed,            ///< its producer dies
};
inline constexpr std::size_t kEndings = 5;
[[nodiscard]] std::string_view to_string(Ending ending) noexcept;

/// When a life ends, relative to its last waypoint.
enum class When : std::uint8_t {
  early,         ///< long before it
  last_segment,  ///< within the last segment
  in_stop,       ///< in the stop after it
  at_rest,       ///< at rest
};
inline constexpr std::size_t kWhens = 4;
[[nodiscard]] std::string_view to_string(When when) noexcept;

/// Where the bounds of a life are.
enum class Walls : std::uint8_t {
  none,
  wide,     ///< far away
  touched,  ///< at the extremes of the waypoints
  near,     ///< just after the last waypoint, in the direction in which it is reached
  passed,   ///< within the range of the waypoints
};
inline constexpr std::size_t kWalls = 5;
[[nodiscard]] std::string_view to_string(Walls walls) noexcept;

/// The waypoints of a motion, with all derivatives.
struct Motion {
  std::vector<Time> times{};
  std::vector<double> values{};  ///< [waypoint][derivative][dimension]

  [[nodiscard]] std::span<const double> value(std::size_t i, std::size_t derivative,
                                              std::size_t dimensions) const {
    return std::span(values).subspan((3 * i + derivative) * dimensions, dimensions);
  }
};

/// The random parameters of one life.
struct LifePlan {
  StreamPlan stream{};
  Motion motion{};
  Time lead{};  ///< of the waypoints
  Ending ending{};
  When when{};
  Walls walls{};
  Time end_at{};               ///< stream time of the first item of the end
  Time finish_after{};         ///< of a life that is stopped: from the stop to the finish
  double rate = 1;             ///< stream time per host time
  Time held_at = Time::max();  ///< a law holds the stream from this stream time on
  Time held_for{};             ///< in host time
  double takeover = 0;         ///< probability that a step is made by a new solver
};

/// The plan of a seed. `random` has the same seed.
[[nodiscard]] LifePlan make_life(std::uint64_t seed, Random& random);

}  // namespace splinecast::campaign::ends
