#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "splinecast/core/run_entry.hpp"
#include "splinecast/core/segment.hpp"
#include "splinecast/core/sliding_window.hpp"
#include "splinecast/core/state.hpp"
#include "splinecast/ipc/word.hpp"

/// Where runs of a published curve meet: what the next one goes on from, and the way back at the
/// end. Formulas only, so that whoever solves a curve again takes the ones that it was solved by.
/// Nothing allocates or throws.
namespace splinecast::ipc {

/// The waypoints that stand before a run: those that count.
using StandingWaypoints = std::array<core::StandingWaypoint, 2>;

/// Segments behind a run's beginning that are looked at for standing waypoints: those of entries,
/// stops and holds lie between.
inline constexpr int kStandingLookBack = 16;

/// Where a segment that is to be cut begins and ends, and its polynomial.
struct CutSegment {
  core::Time left{};
  core::Time right{};
  int order = core::kCubicOrder;
  std::span<const double> coefficients{};
};

/// Evaluates a segment where a run is to begin at t: at rest behind the segment's end, and before
/// its beginning, where the machine stands until then. O(D).
void evaluate_at_cut(const CutSegment& segment, core::Time t, core::State& out) noexcept;

/// How a stream that is finished after its newest knot had been frozen goes back to it.
struct WayBack {
  core::Time rest;      ///< when the stop tail has come to rest
  core::Time duration;  ///< that the way takes
};

/// The way back to `knot`, the window's newest: nothing where the stop tail ends there already.
/// `at_rest` becomes the state at the stop tail's end; `scratch` is overwritten. O(D).
[[nodiscard]] std::optional<WayBack> way_back(const core::SlidingWindow& window,
                                              const core::Knot& knot, core::Segment& scratch,
                                              core::State& at_rest) noexcept;

/// Writes the splice of a way back that begins at `start`. O(D).
void build_way_back(const WayBack& way, core::Time start, std::span<const double> from,
                    std::span<const double> to, core::Segment& out) noexcept;

}  // namespace splinecast::ipc
