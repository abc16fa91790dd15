#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/limits/extremes.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/state.hpp"

/// Compares segments with motion limits.
///
/// Compares every dimension by its extremes (extremes.hpp). A limit counts as respected if an
/// extreme exceeds it by no more than its rounding error. NaN exceeds every limit.
///
/// The four dimensions of a quaternion q are one rotation. The limits of its first dimension apply
/// to |ω|, |α| and |α̇| in the body frame, as readers see them: those of q/|q|. They follow from N
/// = |q|² and W = vec(q*⊗q̇):
///
///     ω = 2W/N,   α = ω̇ = 2(ẆN − WṄ)/N²,
///
/// so that |ω| ≤ 2|q̇|/|q| and |α| ≤ 2|q̈|/|q| + 4|q̇|²/|q|². These are rational functions of the
/// time. The check uses an upper bound of each, within 10⁻⁶ of its peak. A quaternion that comes
/// near 0 exceeds every limit.
///
/// Limits must have passed `require_limits` for the curve's dimensions. `kinds` may be null: all
/// linear. Functions are O(D), do not allocate or throw, and are safe from any thread.
namespace splinecast::core {

/// Values that are allowed although they exceed a limit: one per dimension, or an empty span. A
/// motion that begins above its limit may keep that value. A value below the limit has no effect.
struct Allowance {
  std::span<const double> velocity{};
  std::span<const double> acceleration{};
};

/// Whether a part of a curve respects all limits.
[[nodiscard]] bool keeps_within(const MotionLimits& limits, const DimensionKinds* kinds,
                                const SegmentPart& part, const Allowance& allowance = {}) noexcept;
[[nodiscard]] bool keeps_within(const MotionLimits& limits, const DimensionKinds* kinds,
                                const Segment& segment, const Allowance& allowance = {}) noexcept;

/// Whether a part of a curve exceeds no limit that `other` keeps, and none by more than `other`:
/// each kind of limit in each dimension.
[[nodiscard]] bool exceeds_no_more(const MotionLimits& limits, const DimensionKinds* kinds,
                                   const SegmentPart& part, const SegmentPart& other) noexcept;

/// Whether the quaternions of a segment keep at least the length 0.7, so that their rotation is
/// well defined. Looks at 15 times.
[[nodiscard]] bool keeps_length(const DimensionKinds& kinds, const Segment& segment) noexcept;

/// The largest excess of each kind, indexed by LimitKind. `keeps_within` is true for ratios up to 1
/// and for those that exceed 1 by rounding.
using WorstExcesses = std::array<Excess, kLimitKinds>;
[[nodiscard]] WorstExcesses worst_excesses(const MotionLimits& limits, const DimensionKinds* kinds,
                                           const SegmentPart& part,
                                           const Allowance& allowance = {}) noexcept;

/// The largest excess of all kinds.
[[nodiscard]] Excess worst_excess(const MotionLimits& limits, const DimensionKinds* kinds,
                                  const SegmentPart& part,
                                  const Allowance& allowance = {}) noexcept;
[[nodiscard]] Excess worst_excess(const MotionLimits& limits, const DimensionKinds* kinds,
                                  const Segment& segment, const Allowance& allowance = {}) noexcept;

/// The largest excess of one state: `u` is 0.
[[nodiscard]] Excess worst_excess(const MotionLimits& limits, const DimensionKinds* kinds,
                                  const State& state) noexcept;

/// The ratio of an excess, as in Excess, from its value and its limit; for a position, the bounds
/// of the dimension. O(1).
[[nodiscard]] double ratio_of(const MotionLimits& limits, LimitKind kind, std::size_t dimension,
                              double value, double limit) noexcept;

/// The first point at which a limit is exceeded, to 10⁻⁹ of the part's length, with the value
/// there; nothing if all limits are respected.
[[nodiscard]] std::optional<Excess> first_violation(const MotionLimits& limits,
                                                    const DimensionKinds* kinds,
                                                    const SegmentPart& part,
                                                    const Allowance& allowance = {}) noexcept;
[[nodiscard]] std::optional<Excess> first_violation(const MotionLimits& limits,
                                                    const DimensionKinds* kinds,
                                                    const Segment& segment,
                                                    const Allowance& allowance = {}) noexcept;

}  // namespace splinecast::core
