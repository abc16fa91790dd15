#pragma once

#include <cstddef>
#include <span>

#include "core/polynomial/segment.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/state.hpp"

/// Where pieces of a published curve meet: what the next one goes on from, and what follows an
/// entry beyond the newest waypoint. Formulas only, so that verification uses those of the solver.
/// Nothing allocates or throws.
namespace splinecast::ipc {

/// Where a segment that is to be cut begins and ends, and its polynomial.
struct CutSegment {
  Time left{};
  Time right{};
  int order = kCubicOrder;
  std::span<const double> coefficients{};
};

/// Evaluates a segment where a run is to begin at t: at rest behind the segment's end, and before
/// its beginning, where the machine stands until then. O(D).
void evaluate_at_cut(const CutSegment& segment, Time t, State& out) noexcept;

/// The times of what follows an entry that ends beyond the newest waypoint: the rest of the
/// straight line, unless the entry ends later, and the stop.
struct BehindEntry {
  Time end{};       ///< of the entry
  Time line_end{};  ///< of the line
  Time rest{};      ///< of the stop

  [[nodiscard]] bool has_line() const noexcept { return end < line_end; }
  [[nodiscard]] Time stop_begin() const noexcept { return has_line() ? line_end : end; }
  [[nodiscard]] Time stop_length() const noexcept;

  /// Writes where the line ends.
  void write_line_end(std::span<const double> position, std::span<const double> velocity,
                      std::span<double> out) const noexcept;
};

}  // namespace splinecast::ipc
