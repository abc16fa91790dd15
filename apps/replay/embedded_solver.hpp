#pragma once

#include <functional>
#include <optional>

#include "apps/replay/player.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::apps {

/// The optional solver in a replay's own process. It is stepped whenever it is due, also while the
/// replay waits.
class EmbeddedSolver {
 public:
  /// Throws if there is another solver. Calls `after_step` after each step that consumed an item.
  EmbeddedSolver(const ReplayOptions& options, std::function<void()> after_step);

  /// Solves all items in the ring.
  void solve();

  /// Sleeps until an instant, and steps the solver each time it is due. Returns false if a stop is
  /// requested.
  [[nodiscard]] bool wait_until(Time instant);

  [[nodiscard]] bool is_due() const { return solver_ && solver_->due() <= clock_.now(); }

  /// Longest that this process may block: the solver must be stepped by its due time.
  [[nodiscard]] Time slice() const;

 private:
  MonotonicClock clock_;
  std::optional<Solver> solver_;
  std::function<void()> after_step_;
};

}  // namespace splinecast::apps
