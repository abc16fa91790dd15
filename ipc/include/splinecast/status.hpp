#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "splinecast/limits.hpp"
#include "splinecast/time.hpp"

namespace [[gnu::visibility("default")]] splinecast {

/// The result of `append`. Only `accepted` changes anything.
enum class AppendStatus : std::uint8_t {
  accepted,
  full,             ///< the ring has no room until the solver consumes; retry
  past,             ///< live streams only: the time is before the settled time, and by more than
                    ///< 250 ms before the later of the settled time and now; for the first waypoint
                    ///< or a start state: the time is before the settled time or, unless the stream
                    ///< follows a law, before now; see compared_with_now()
  duplicate,        ///< the time equals that of the previous waypoint
  out_of_order,     ///< the time is earlier than that of the previous waypoint
  not_finite,       ///< a value is infinite, NaN, or outside ±kLargestValue
  too_close,        ///< less than min_interval after the previous waypoint
  too_far_apart,    ///< more than max_interval after the previous waypoint (live stream: and after
                    ///< the settled time and now); or a time, also that of a replacement, is
                    ///< outside ±2⁶² ns; or ReplaceOptions::blend is longer than max_interval
  wrong_dimension,  ///< a span does not have one value per dimension
  too_late,         ///< a replacement with waypoints at a time that has settled or, on a live
                    ///< stream, is before now + freeze_ahead: see Producer::earliest()
  too_many,         ///< a replacement that does not fit even into an empty ring
  already_started,  ///< a start state after the first waypoint
  finished,         ///< the stream has been finished
  cannot_follow,    ///< with Beyond::enter: no waypoint has been met for 3 s, and the curve is
                    ///< planned to move until this time; continue with the next waypoint
  too_far_ahead,    ///< live streams without a law: the time, also that of a replacement, a stop or
                    ///< a start state, is more than ProducerOptions::horizon after now; see
                    ///< compared_with_now()
  elsewhere,  ///< the first waypoint or a start state of a live stream is not where an earlier
              ///< stream of the name has left the machine; see Producer::why_elsewhere()
  stopped,    ///< a stopper holds the stream, which takes stops and a finish only; see
              ///< Producer::stopped_by()
};
inline constexpr std::uint8_t kAppendStatuses = 17;

/// Why the solver refused an item that the ring had accepted. Each reason has its own counter.
enum class Refusal : std::uint8_t {
  past = 1,  ///< more than 250 ms before the settled time; first waypoint or start state: before
             ///< the settled time; live streams only
  duplicate = 2,
  out_of_order = 3,
  not_finite = 4,  ///< a value is not usable, or makes the curve not finite
  too_close = 5,
  too_far_apart = 6,
  too_late = 7,  ///< a plan of a time law at a settled time; of earlier versions a replacement
  after_finish = 8,
  already_started = 9,  ///< a start state after the first waypoint
  unknown_kind = 10,
  lacks_derivatives = 11,  ///< the method needs a velocity, or acceleration, that is not given
  lag_too_short = 12,      ///< the settle lag is too short for λ with waypoints this close
  zero_quaternion = 13,    ///< a quaternion has length 0, or one outside 1e-100 to 1e100
  beyond_limits = 14,      ///< the curve would exceed a limit, and Beyond::refuse is set
  cannot_follow = 15,      ///< with Beyond::enter: no waypoint has been met for 3 s, and no
                           ///< entry from rest can lead to this one
  stopped = 16,            ///< a stopper held the stream; see ItemRefusal::by
};
inline constexpr std::uint8_t kRefusals = 17;

/// What became of an item that the ring has accepted.
enum class OutcomeKind : std::uint8_t {
  waiting,      ///< no solver has taken it yet
  undecided,    ///< taken, but the curve waits for, or is in, a transition that may still pass over
                ///< it
  in_force,     ///< the curve is at the waypoint, or does what the item asks, at `time`
  passed_over,  ///< the curve goes from before the waypoint to a later one
  withdrawn,    ///< a replacement or a stop, also that of a stopper, took its place
  refused,      ///< by the solver, for `reason`
  forgotten,    ///< not known any more: see Producer::outcome()
};
inline constexpr std::size_t kOutcomeKinds = 7;

/// By which part of the curve an item is in force.
enum class OutcomeWay : std::uint8_t {
  spline,  ///< the spline through the waypoints
  entry,   ///< a transition: it ends at the waypoint, or begins with the replacement or start state
  stop,    ///< a stop, which begins at `time`
  end,     ///< the end of the stream: the curve slows down or ends there, or, of the item that
           ///< finished the stream, rests from then on
};
inline constexpr std::size_t kOutcomeWays = 4;

/// The outcome of an item.
struct ItemOutcome {
  OutcomeKind kind{};
  std::optional<Time> time{};  ///< in_force only: when. Of a replacement that came late, and of the
                               ///< waypoints of an end that slows down, later than its own time
  OutcomeWay way{};            ///< in_force only
  Refusal reason{};            ///< refused only
  bool is_final = false;  ///< nothing can change it any more: it is in force at a time that has
                          ///< settled, passed over, withdrawn or refused

  friend bool operator==(const ItemOutcome&, const ItemOutcome&) = default;
};

/// Whether it is known what became of the item.
[[nodiscard]] constexpr bool is_known(const ItemOutcome& outcome) noexcept {
  return outcome.kind != OutcomeKind::waiting && outcome.kind != OutcomeKind::undecided;
}

/// The validity of a sample.
enum class SampleStatus : std::uint8_t {
  settled,          ///< final: every reader gets the same bits at this time, now and later
  provisional,      ///< not settled yet: a newer waypoint or a replacement may still change it
  stopping,         ///< in the stop segment after the newest waypoint
  holding,          ///< at rest: after the end, or before the first waypoint of a live stream
  revised,          ///< valid, but the curve has changed at or before a time that this reader has
                    ///< already sampled; reported once; live streams only
  before_history,   ///< before what the board keeps, or before the start of a recorded stream; no
                    ///< values
  no_data,          ///< no waypoint has been solved yet, or before the start of a live stream that
                    ///< starts in motion; no values
  busy,             ///< the writer overtook every try: retry; or the board's data is not a segment;
                    ///< no values
  retired,          ///< the stream was removed or created again: make a new Reader; no values
  wrong_dimension,  ///< a span, or the snapshot, does not have one value per dimension; no values
};

inline constexpr std::size_t kSampleStatuses = 10;

/// A place where the curve exceeds a limit: the place farthest beyond the limit, in the first
/// segment that exceeds one.
struct LimitExcess {
  std::uint64_t item = 0;   ///< number of the waypoint's item
  bool is_refused = false;  ///< the waypoint was refused; else accepted
  LimitKind kind{};
  std::size_t dimension = 0;  ///< for a quaternion, its first dimension
  Time time{};
  double value = 0;  ///< with its sign; for a quaternion, an upper bound of its magnitude
  double limit = 0;  ///< the limit, or the bound of a position
};

/// What one step of a solver did.
struct StepResult {
  std::uint64_t consumed = 0;  ///< ring items consumed
  bool published = false;      ///< whether a revision was committed
  bool missed = false;         ///< whether a revision was discarded because it was too late; then
                               ///< call step again
  bool damaged = false;        ///< whether another process has written to the board; then the step
                               ///< did nothing
};

/// Whether a sample of this status has values.
[[nodiscard]] constexpr bool has_values(SampleStatus status) noexcept {
  return status <= SampleStatus::revised;
}

/// The text used in files and messages: `before history`, `out of order`, …
[[nodiscard]] std::string_view to_string(AppendStatus status) noexcept;
[[nodiscard]] std::string_view to_string(Refusal refusal) noexcept;
[[nodiscard]] std::string_view to_string(SampleStatus status) noexcept;
[[nodiscard]] std::string_view to_string(OutcomeKind kind) noexcept;
[[nodiscard]] std::string_view to_string(OutcomeWay way) noexcept;

/// `in force at 123 ns: entry`, `refused: too late`, `passed over`
[[nodiscard]] std::string to_string(const ItemOutcome& outcome);

}  // namespace splinecast
