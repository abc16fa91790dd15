#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "splinecast/limits.hpp"
#include "splinecast/time.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// What `append` answers. Only `accepted` changes anything.
enum class AppendStatus : std::uint8_t {
  accepted,
  full,             ///< the ring has no room until the solver consumes; try again
  past,             ///< the time has settled and lies more than 250 ms before what has settled,
                    ///< or before now if that is later; of a first waypoint or a start state:
                    ///< the time has settled. Live streams only
  duplicate,        ///< the time is that of the waypoint before
  out_of_order,     ///< the time is earlier than that of the waypoint before
  not_finite,       ///< a value is infinite, not a number, or beyond ±kLargestValue
  too_close,        ///< less than the least interval after the waypoint before
  too_far_apart,    ///< more than the most interval after the waypoint before (on a live stream:
                    ///< after it, after what has settled and after now); a time, that of a
                    ///< replacement too, not within ±2⁶² ns; or ReplaceOptions::blend longer
                    ///< than the most interval
  wrong_dimension,  ///< a span does not have one value per dimension
  too_late,         ///< a replacement with waypoints from before Producer::earliest() or, on a
                    ///< live stream, from before now
  too_many,         ///< a replacement that no ring of this size has room for
  already_started,  ///< a start state behind the first waypoint
  finished,         ///< the stream has been finished
};
inline constexpr std::uint8_t kAppendStatuses = 13;

/// Why the solver refused an item that the ring had accepted. Counted one by one.
enum class Refusal : std::uint8_t {
  past = 1,  ///< more than 250 ms before what has settled, or the first waypoint or a start state
             ///< before it; live streams only
  duplicate = 2,
  out_of_order = 3,
  not_finite = 4,  ///< a value is not usable, or the curve would have one that is not finite
  too_close = 5,
  too_far_apart = 6,
  too_late = 7,  ///< a replacement from a time that has settled, or a waypoint of one
  after_finish = 8,
  already_started = 9,  ///< a start state behind the first waypoint
  unknown_kind = 10,
  lacks_derivatives = 11,  ///< the method needs a velocity, or acceleration, that is not given
  lag_too_short = 12,      ///< the settle lag is too short for λ with waypoints so close
  zero_quaternion = 13,    ///< a quaternion has length 0, or one outside 1e-100 to 1e100
  beyond_limits = 14,      ///< the curve would be beyond a limit, and that is to be refused
};
inline constexpr std::uint8_t kRefusals = 15;

/// What a sample is worth.
enum class SampleStatus : std::uint8_t {
  settled,          ///< final: every reader, now or later, gets these bits
  provisional,      ///< not settled yet: a newer waypoint or a replacement may still change it
  stopping,         ///< in the stop segment behind the newest waypoint
  holding,          ///< at rest: past the end, or before the first waypoint of a live stream
  revised,          ///< good as it is, but the curve has been changed before a time that this
                    ///< reader had sampled; said once; live streams only
  before_history,   ///< older than what the board keeps, or before a recorded stream; no values
  no_data,          ///< no waypoint has been solved yet, or before a live stream that starts in
                    ///< motion; no values
  busy,             ///< the writer overtook every try: try again; or what lies there is no
                    ///< segment; no values
  retired,          ///< the stream was removed or made again: make a new Reader; no values
  wrong_dimension,  ///< a span, or the snapshot, does not have one value per dimension; no values
};

inline constexpr std::size_t kSampleStatuses = 10;

/// Where a limit was passed: of the first segment beyond one, the place that is farthest beyond.
struct LimitExcess {
  std::uint64_t item = 0;   ///< of the waypoint
  bool is_refused = false;  ///< else it was taken
  LimitKind kind{};
  std::size_t dimension = 0;  ///< of a quaternion its first
  Time time{};
  double value = 0;  ///< with its sign; of a quaternion a bound of its magnitude
  double limit = 0;  ///< or the bound of a position
};

/// What one step of a solver did.
struct StepResult {
  std::uint64_t consumed = 0;  ///< ring items taken
  bool published = false;      ///< whether a revision was committed
  bool missed = false;         ///< whether one was discarded because it came too late: step again
  bool damaged = false;        ///< whether somebody else has written to the board: nothing is done
};

/// Whether a sample of this status has values.
[[nodiscard]] constexpr bool has_values(SampleStatus status) noexcept {
  return status <= SampleStatus::revised;
}

/// In words, as files and messages have them: `before history`, `out of order`, …
[[nodiscard]] std::string_view to_string(AppendStatus status) noexcept;
[[nodiscard]] std::string_view to_string(Refusal refusal) noexcept;
[[nodiscard]] std::string_view to_string(SampleStatus status) noexcept;

}  // namespace splinecast
