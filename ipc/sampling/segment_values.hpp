#pragma once

#include <algorithm>
#include <span>

#include "core/polynomial/segment.hpp"
#include "ipc/sampling/seconds.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/piecewise_polynomial.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

/// The values of a published segment, as all readers have them, also those of a recording.
namespace splinecast::ipc {

/// A segment, for its values. A view.
struct SegmentView {
  Time left{};
  Time right{};
  int order = kCubicOrder;
  SegmentKind kind{};
  std::span<const double> coefficients;
};

/// Sets velocity, acceleration and jerk to 0: at rest.
inline void come_to_rest(const StateRef& out) noexcept {
  std::ranges::fill(out.velocity, 0.0);
  std::ranges::fill(out.acceleration, 0.0);
  std::ranges::fill(out.jerk, 0.0);
}

/// Whether the machine rests at t: after the segment, in a hold, and at the end of a stop.
[[nodiscard]] inline bool rests_at(const SegmentView& segment, Time t) noexcept {
  return t > segment.right || segment.kind == SegmentKind::hold ||
         (t == segment.right && segment.kind == SegmentKind::stop);
}

/// The values `fraction` seconds after t, t ≥ left, 0 ≤ fraction ≤ 1e-9, normalised for `kinds`. At
/// rest, those at the right end. The bits depend on the arguments only. O(order·D); never throws or
/// allocates.
inline void values_at(const SegmentView& segment, const DimensionKinds& kinds, Time t,
                      double fraction, const StateRef& out) noexcept {
  const bool rests = rests_at(segment, t);
  const double u = seconds_after(segment.left, rests ? segment.right : t);
  core::evaluate(segment.order, segment.coefficients, u + (rests ? 0.0 : fraction), out);
  if (!kinds.all_linear()) kinds.normalise(out);
  if (rests) come_to_rest(out);
}

/// The values before the first segment of a live stream, which holds the machine at its start
/// position. Returns false, and writes nothing, if the stream starts in motion.
[[nodiscard]] inline bool values_before(const SegmentView& first, const DimensionKinds& kinds,
                                        const StateRef& out) noexcept {
  const std::size_t dimensions = out.position.size();
  const auto velocity = first.coefficients.subspan(dimensions, dimensions);
  if (std::ranges::any_of(velocity, [](double v) { return v != 0; })) return false;
  // Copies instead of evaluating: coefficients that may still change would affect the sign of a 0.
  std::ranges::copy(first.coefficients.first(dimensions), out.position.begin());
  come_to_rest(out);
  if (!kinds.all_linear()) kinds.normalise(out);
  return true;
}

}  // namespace splinecast::ipc
