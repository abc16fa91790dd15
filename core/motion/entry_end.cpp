#include "core/motion/entry_end.hpp"

#include "core/forms/instant.hpp"

namespace splinecast::core {
namespace {

/// A shorter rest of the straight line is left out: the derivatives of so short a segment are those
/// of the rounding errors of its positions.
constexpr Time kShortestLine{1'000'000};

}  // namespace

EntryEnd end_at_knot(const SlidingWindow& target, std::size_t knot, State& state) noexcept {
  const Knot at = target.knot(knot);
  target.write_acceleration(knot, state.ref().acceleration);
  return {.knot = knot,
          .known = target.knots(),
          .state = {.time = at.time,
                    .position = at.position,
                    .velocity = at.velocity,
                    .acceleration = state.acceleration()}};
}

EntryEnd end_ahead(const SlidingWindow& target, const Extrapolation& after, Time t,
                   State& state) noexcept {
  const Time line = after.line_end() - t;
  if (line > Time::zero() && line < kShortestLine) t = after.line_end();
  after.state_at(t, state.ref());
  return {.known = target.knots(),
          .state = instant_of(t, state),
          .line_end = after.line_end(),
          .rest = after.rest()};
}

}  // namespace splinecast::core
