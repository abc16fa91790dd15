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

/// Compares segments with limits of motion.
///
/// Every dimension is compared by its extremes (extremes.hpp); a value beyond its limit by
/// no more than their rounding keeps it. A value that is no number keeps no limit.
///
/// The four dimensions of a quaternion q are one rotation, compared under the first of them with
/// the limits given for that one: |ω|, |α| and |α̇| in the body's frame, of what readers see, which
/// is q/|q|. With N = |q|² and W = vec(q*⊗q̇),
///
///     ω = 2W/N,   α = ω̇ = 2(ẆN − WṄ)/N²,
///
/// so that |ω| ≤ 2|q̇|/|q| and |α| ≤ 2|q̈|/|q| + 4|q̇|²/|q|². They are rational functions of the
/// time, and are bounded from above, within 10⁻⁶ of their peak. A quaternion that comes near 0
/// keeps no limit.
///
/// Limits have passed `require_limits` for the curve's dimensions. Kinds may be null: all linear.
/// Every function is O(D), allocates nothing and throws nothing; safe from any thread.
namespace splinecast::core {

/// Values that are allowed although they exceed a limit: one per dimension, or none. A motion that
/// begins beyond its limit may stay there. A value below the limit changes nothing.
struct Allowance {
  std::span<const double> velocity{};
  std::span<const double> acceleration{};
};

/// Whether a part of a curve keeps all limits.
[[nodiscard]] bool keeps_within(const MotionLimits& limits, const DimensionKinds* kinds,
                                const SegmentPart& part, const Allowance& allowance = {}) noexcept;
[[nodiscard]] bool keeps_within(const MotionLimits& limits, const DimensionKinds* kinds,
                                const Segment& segment, const Allowance& allowance = {}) noexcept;

/// The largest excess of each kind, in the places of their numbers. `keeps_within` is true for
/// ratios up to 1, and for those beyond it by rounding.
using WorstExcesses = std::array<Excess, kLimitKinds>;
[[nodiscard]] WorstExcesses worst_excesses(const MotionLimits& limits, const DimensionKinds* kinds,
                                           const SegmentPart& part,
                                           const Allowance& allowance = {}) noexcept;

/// The largest of all kinds.
[[nodiscard]] Excess worst_excess(const MotionLimits& limits, const DimensionKinds* kinds,
                                  const SegmentPart& part,
                                  const Allowance& allowance = {}) noexcept;
[[nodiscard]] Excess worst_excess(const MotionLimits& limits, const DimensionKinds* kinds,
                                  const Segment& segment, const Allowance& allowance = {}) noexcept;

/// The largest for one state: `u` is 0.
[[nodiscard]] Excess worst_excess(const MotionLimits& limits, const DimensionKinds* kinds,
                                  const State& state) noexcept;

/// The first place where a limit is passed, with the value there; nothing if all are kept. It is
/// found to 10⁻⁹ of the part's length.
[[nodiscard]] std::optional<Excess> first_violation(const MotionLimits& limits,
                                                    const DimensionKinds* kinds,
                                                    const SegmentPart& part,
                                                    const Allowance& allowance = {}) noexcept;
[[nodiscard]] std::optional<Excess> first_violation(const MotionLimits& limits,
                                                    const DimensionKinds* kinds,
                                                    const Segment& segment,
                                                    const Allowance& allowance = {}) noexcept;

}  // namespace splinecast::core
