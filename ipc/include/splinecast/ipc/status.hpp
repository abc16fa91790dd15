#pragma once

#include <cstdint>
#include <string_view>

namespace splinecast::ipc {

/// What `append` answers. Only `accepted` changes anything.
enum class AppendStatus : std::uint8_t {
  accepted,
  full,                   ///< the ring has no room until the solver consumes; try again
  not_increasing,         ///< the time is not after that of the waypoint before
  not_finite,             ///< a value is infinite, not a number, or beyond ±core::kLargestValue
  wrong_dimension,        ///< a span does not have one value per dimension
  interval_out_of_range,  ///< too close to the waypoint before, or too far from it, or the time
                          ///< itself lies beyond ±2⁶² ns
  finished,               ///< the stream has been finished
};

/// Why the solver refused an item that the ring had accepted. Counted one by one.
enum class Refusal : std::uint8_t {
  not_increasing = 1,
  not_finite = 2,
  interval_out_of_range = 3,
  after_finish = 4,
  unknown_kind = 5,
  lacks_derivatives = 6,  ///< the method needs a velocity, or acceleration, that is not given
  lag_too_short = 7,      ///< the settle lag is too short for λ with waypoints so close
};
inline constexpr std::uint8_t kRefusals = 8;

/// What a sample is worth.
enum class SampleStatus : std::uint8_t {
  settled,         ///< final: every reader, now or later, gets these bits
  provisional,     ///< a newer waypoint may still change it
  stopping,        ///< in the stop tail behind the newest waypoint
  holding,         ///< at rest: past the end, or before the first waypoint of a live stream
  before_history,  ///< older than what the board keeps, or before a recorded stream; no values
  no_data,         ///< no waypoint has been solved yet; no values
  busy,            ///< the writer overtook every try; no values, try again
  retired,         ///< the region is of no more use: attach again; no values
};

/// Whether a sample of this status has values.
[[nodiscard]] constexpr bool has_values(SampleStatus status) noexcept {
  return status <= SampleStatus::holding;
}

/// In words, as files and messages have them: `before history`, `not increasing`, …
[[nodiscard]] std::string_view to_string(AppendStatus status) noexcept;
[[nodiscard]] std::string_view to_string(Refusal refusal) noexcept;
[[nodiscard]] std::string_view to_string(SampleStatus status) noexcept;

}  // namespace splinecast::ipc
