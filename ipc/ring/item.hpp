#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/online/extrapolation.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/options.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

/// What a ring item says.
enum class ItemKind : std::uint8_t {
  waypoint = 1,
  replace = 2,      ///< withdraws the future from a time on; so many waypoints follow
  start_state = 3,  ///< the state that a stream starts in
  finish = 4,       ///< the stream ends at its last waypoint, with a condition there
};

/// A ring item with memory of its own. Allocates when made only.
struct RingItem {
  explicit RingItem(std::size_t dimensions) : values(3 * dimensions) {}

  ItemKind kind = ItemKind::waypoint;
  bool has_velocity = false;
  bool has_acceleration = false;
  ConditionKind condition{};  ///< of a finish
  std::uint32_t count = 0;    ///< of a replacement: waypoints that belong to it
  Time blend{};               ///< of one with waypoints: its entry takes at least so long
  Time time{};
  std::vector<double> values;  ///< positions, velocities, accelerations: those that it has

  /// The item's waypoint or state, a view of `values`.
  [[nodiscard]] Waypoint waypoint() const noexcept;
};

/// How late a waypoint of a live stream may come, before what has settled, and still shape the
/// target that an entry leads back to: the straight line behind the one before it is over by then.
/// It is passed over.
inline constexpr Time kMostLate = core::Extrapolation::kLine;
static_assert(kMostLate == Time{250'000'000});  // as Refusal::past says

/// Whether a waypoint may follow another one this much earlier: `accepted`, or why not.
[[nodiscard]] constexpr AppendStatus judge_interval(Time interval,
                                                    const IngestLimits& limits) noexcept {
  if (interval == Time::zero()) return AppendStatus::duplicate;
  if (interval < Time::zero()) return AppendStatus::out_of_order;
  if (interval < limits.min_interval) return AppendStatus::too_close;
  if (interval > limits.max_interval) return AppendStatus::too_far_apart;
  return AppendStatus::accepted;
}

/// Whether all values are numbers within ±kLargestValue.
[[nodiscard]] bool is_finite(std::span<const double> values) noexcept;
[[nodiscard]] bool is_finite(const Waypoint& waypoint) noexcept;

}  // namespace splinecast::ipc
