#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/motion/extrapolation.hpp"
#include "splinecast/boundary_condition.hpp"
#include "splinecast/options.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {

/// The kinds of ring items.
enum class ItemKind : std::uint8_t {
  waypoint = 1,
  replace = 2,      ///< withdraws everything after a time; `count` waypoints follow
  start_state = 3,  ///< the state that a stream starts in
  finish = 4,       ///< the stream ends at its last waypoint, with a boundary condition there
  rate = 5,         ///< a piece of a time law's rate; `count` further pieces of its plan follow
};

/// A piece of a time law's rate, as its item has it: the cubic from the state at the item's time to
/// this rate with slope 0.
struct RateItem {
  double end_rate = 0;
  Time length{};
};

/// A copy of a ring item. Allocates only in its constructor.
struct RingItem {
  explicit RingItem(std::size_t dimensions) : values(3 * dimensions) {}

  ItemKind kind = ItemKind::waypoint;
  bool has_velocity = false;
  bool has_acceleration = false;
  ConditionKind condition{};   ///< of a finish
  std::uint8_t commander = 0;  ///< of a piece: slot of the commander whose request it follows
  std::uint8_t place = 0;      ///< of a piece: its number in the plan, from 0
  std::uint32_t count = 0;  ///< of a replacement: waypoints that belong to it; of a piece: pieces
                            ///< of the plan after it
  Time blend{};             ///< of a replacement with waypoints: least duration of its entry
  Time time{};
  std::vector<double> values;  ///< positions, velocities, accelerations; only those that the item
                               ///< has are set

  /// The item's waypoint or state, a view of `values`.
  [[nodiscard]] Waypoint waypoint() const noexcept;

  /// Of a piece: the number of the commander's request.
  [[nodiscard]] std::uint64_t request() const noexcept {
    return std::bit_cast<std::uint64_t>(values[2]);
  }
};

/// Maximum lateness of a waypoint of a live stream: the time by which it may be before the settled
/// time. A late waypoint becomes part of the target, to which an entry returns, but is itself
/// passed over. After this time, the straight line that extrapolates from the previous waypoint has
/// ended.
inline constexpr Time kMostLate = core::Extrapolation::kLineLength;
static_assert(kMostLate == Time{250'000'000});  // as Refusal::past says

/// The interval allowed between two consecutive waypoints.
struct IntervalRange {
  Time least = IngestLimits{}.min_interval;
  Time most = IngestLimits{}.max_interval;
};

/// Whether a waypoint may follow another one after this interval: `accepted`, or the reason why
/// not.
[[nodiscard]] constexpr AppendStatus judge_interval(Time interval,
                                                    const IntervalRange& range) noexcept {
  if (interval == Time::zero()) return AppendStatus::duplicate;
  if (interval < Time::zero()) return AppendStatus::out_of_order;
  if (interval < range.least) return AppendStatus::too_close;
  if (interval > range.most) return AppendStatus::too_far_apart;
  return AppendStatus::accepted;
}

/// A piece of a law from the values of its item; nothing if no planner writes such values.
[[nodiscard]] std::optional<RateItem> piece_of(const Waypoint& values) noexcept;

/// Whether all values are finite and within ±kLargestValue.
[[nodiscard]] bool is_finite(std::span<const double> values) noexcept;
[[nodiscard]] bool is_finite(const Waypoint& waypoint) noexcept;

}  // namespace splinecast::ipc
