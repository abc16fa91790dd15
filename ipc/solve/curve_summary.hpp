#pragma once

#include "ipc/layout/summary.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::ipc {

/// How a published curve returns to its target.
struct EntryOptions {
  bool is_live = false;  ///< false: an entry waits until K newer waypoints are known
  Time min_entry{};      ///< length of the shortest entry
  Time notice{};         ///< a live stream's start is decided this long before it settles
};

/// A published curve's part of a revision's summary; see the members of Summary.
struct CurveSummary {
  Word first = 0;
  Word newest = 0;
  Time stop{};
  Word run = 1;
  Word run_knots = 0;
  Word run_item = 0;
  Word run_frozen = 0;
  bool is_later_run = false;
  Course course{};
  Word met = 0;
  Word unmet = 0;
  Time blend_until{};
  Word passed_over = 0;
};

/// Copies the curve's part into a summary; the counters stay as they are.
void put_summary(const CurveSummary& curve, Summary& summary) noexcept;

}  // namespace splinecast::ipc
