#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/online/sliding_window.hpp"
#include "core/solvers/knot_ring.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// A copy of a settled knot with its eliminated row, from which a run can be solved on.
struct RestartKnot {
  Time time{};
  core::Prefix prefix{};
  std::vector<double> waypoint{};
  std::vector<double> g{};
  std::vector<double> position{};
  std::vector<double> velocity{};
  std::vector<double> acceleration{};  ///< empty unless the method needs it
  std::vector<double> residual{};      ///< empty unless the method smooths

  /// A view of this object.
  [[nodiscard]] core::Knot view() const noexcept;
};

/// The last settled knots of a run, as a solver that takes over reads them: from these and from
/// the items after them, the rest of the run can be solved again.
struct RunRestart {
  bool is_later_run = false;  ///< as in Summary
  Word run_item = 0;          ///< number of the item of the run's first waypoint
  std::size_t first = 0;      ///< number of the first of `knots` in its run, from 0
  std::vector<RestartKnot> knots{};

  /// Number of the run's knots up to the last one here.
  [[nodiscard]] std::size_t end() const noexcept { return first + knots.size(); }
};

/// Number of knots that a restart has, if its run has that many before it.
[[nodiscard]] std::size_t knots_to_restart(const core::WindowOptions& options) noexcept;

/// Whether knots can continue a run: a valid number of them, increasing times, finite values, as
/// many as the dimensions require.
[[nodiscard]] bool is_sound(const RunRestart& restart, std::size_t dimensions,
                            const core::WindowOptions& options) noexcept;

/// Copies the knots of the newest run up to knot `number` from the board, for an observer. The
/// segment before that knot must have settled under `summary`. Empty if the board does not have
/// them all under that revision, if the knot is not a waypoint of the newest run on its target, or
/// if no newer knot follows. O(K·D). Allocates.
[[nodiscard]] std::optional<RunRestart> copy_restart(const KnotBoardReader& board,
                                                     const Summary& summary,
                                                     const core::WindowOptions& options,
                                                     Word number);

}  // namespace splinecast::ipc
