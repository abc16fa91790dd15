#pragma once

#include <cstddef>
#include <optional>

#include "core/motion/extrapolation.hpp"
#include "core/online/sliding_window.hpp"
#include "splinecast/state.hpp"
#include "splinecast/time.hpp"

namespace splinecast::core {

/// Where an entry ends. The acceleration refers to the state that was given to the functions below,
/// as do position and velocity unless `knot` is set: then they refer to the target.
struct EntryEnd {
  std::optional<std::size_t> knot{};  ///< knot of the target; none: after the newest one
  std::size_t known = 0;              ///< number of knots of the target
  Instant state{};
  Time line_end{};  ///< only without `knot`: end of the straight line, which may be before `state`
  Time rest{};      ///< only without `knot`: end of the stop segment
};

/// The end of an entry at a knot of the target's window. Writes the acceleration to `state`, which
/// has D values. O(D).
[[nodiscard]] EntryEnd end_at_knot(const SlidingWindow& target, std::size_t knot,
                                   State& state) noexcept;

/// The end of an entry at a time at or after the newest knot of the target, or at the end of the
/// straight line if that is less than 1 ms later. `after` begins at that knot. O(D).
[[nodiscard]] EntryEnd end_ahead(const SlidingWindow& target, const Extrapolation& after, Time t,
                                 State& state) noexcept;

}  // namespace splinecast::core
