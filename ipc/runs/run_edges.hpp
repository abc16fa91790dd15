#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/polynomial/segment.hpp"
#include "ipc/layout/request_control.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/state.hpp"

/// Where two pieces of a published curve meet: the state from which the next one continues.
/// Formulas only, which the solver and verification share. Nothing allocates or throws.
namespace splinecast::ipc {

/// The ends and the polynomial of a segment that is to be cut.
struct CutSegment {
  Time left{};
  Time right{};
  int order = kCubicOrder;
  std::span<const double> coefficients{};
};

/// Evaluates a segment at t, where a run begins. From the segment's right end on, and before its
/// left end, the machine is at rest: the result is the position of that end, with zero velocity and
/// acceleration. O(D).
void evaluate_at_cut(const CutSegment& segment, Time t, State& out) noexcept;

/// Sets velocity and acceleration to zero.
void come_to_rest(State& state) noexcept;

/// The latest time of a change that begins at rest where a time law holds the stream, at `rest`:
/// what has settled, and what a producer that wants a change as soon as possible adds as its
/// margin.
[[nodiscard]] inline Time latest_from_rest(Time rest, Time settled, Time settle_ahead) noexcept {
  return std::max(settled, rest + 10 * settle_ahead);
}

/// Whether a replacement or a stop at t begins at rest where a time law holds the stream, at
/// `rest`; t may also be earlier.
[[nodiscard]] inline bool begins_at_rest(Time t, Time rest, Time settled,
                                         Time settle_ahead) noexcept {
  return rest <= settled && t <= latest_from_rest(rest, settled, settle_ahead);
}

/// How a run begins that cuts the curve.
struct RunBegin {
  Time blend{};               ///< least duration of its entry
  bool has_waypoints = true;  ///< else it is a stop
  bool is_from_rest = false;  ///< the machine rests where it begins
  Word stopped_by = 0;        ///< a stopper's stop: see stop_item(); 0: none
};

/// The items that were consumed before a stopper's stop, and the stopper's slot, as the knot at
/// which the stop begins has them in its `item`.
struct StopOrigin {
  Word items = 0;
  Word slot = 0;
};
[[nodiscard]] constexpr Word stop_item(const StopOrigin& origin) noexcept {
  return origin.items * kMostStoppers + origin.slot;
}
[[nodiscard]] constexpr StopOrigin stop_origin(Word item) noexcept {
  return {.items = item / kMostStoppers, .slot = item % kMostStoppers};
}

}  // namespace splinecast::ipc
