#pragma once

#include <optional>
#include <span>

#include "core/laws/rate_curve.hpp"
#include "splinecast/time.hpp"

/// Bounds and plans of a time law's rate. Nothing allocates or throws. Source: math 32.
///
/// Each commander has a *bound*: the rate that the law would have if this commander were its only
/// one. The law's rate exceeds no bound, and goes to the least of the requested rates.
namespace splinecast::core {

/// A request for a rate, with the length of the ramp that leads to it.
struct RateRequest {
  double rate = 1;
  Time ramp{};
};

/// A commander's bound after its new request takes effect at `t`. It continues from the value and
/// the slope that it has there:
///  - downwards by one cubic over the ramp; if it falls already, at most 3 Δ / |slope| long, to
///    stay monotone;
///  - upwards from slope 0;
///  - a rise is first flattened, within a quarter of the new ramp and the rest of the rise.
[[nodiscard]] RateCurve bound_after(const RateCurve& bound, Time t,
                                    const RateRequest& request) noexcept;

/// The curve that a request makes of a law in a state at `t`, without other requests.
[[nodiscard]] RateCurve ramp_alone(Time t, const RateState& from,
                                   const RateRequest& request) noexcept;

/// The shortest piece of a plan. The values of a law's board are seconds since its origin: with
/// shorter pieces their rounding would show in the rate and its slope.
inline constexpr Time kShortestPiece{100'000};

/// The time at which a plan of a law can begin, `t` or a little later: at the end of the law's
/// present piece, if that is less than kShortestPiece away. From there a plan has no shorter piece.
[[nodiscard]] Time plan_begin(const RateCurve& law, Time t) noexcept;

/// Plans the rate of a law from `t` on: a curve that continues `law` there, exceeds none of the
/// bounds, and ends at `target`, the least of the requested rates. `law` is the curve that it has
/// now, `ramp` that of the newest request, at least 4 kShortestPiece; `t` is of plan_begin().
/// Returns nothing if the curve needs no change, or if it has to rise and no rise passes yet: call
/// again in the next step. Takes the first that passes of
///  1. the present curve;
///  2. downwards, the longest of a set of cubics to the target, or two cubics by way of the end of
///     a bound if they are less steep;
///  3. upwards, or against the present slope: flattens first, then takes the ramp or a longer one,
///     or falls as in 2.
/// Each is compared with every bound in closed form. If nothing passes although the present curve
/// exceeds a bound, falls to the target within kShortestPiece: no plan raises the rate beyond a
/// bound. The curve begins at `t` and has one to three pieces, none shorter than kShortestPiece.
/// Each comparison is O(number of bounds), and their number is bounded.
[[nodiscard]] std::optional<RateCurve> plan_rate(const RateCurve& law, Time t,
                                                 std::span<const RateCurve> bounds, double target,
                                                 Time ramp) noexcept;

}  // namespace splinecast::core
