#include "apps/replay/embedded_solver.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "apps/process/signals.hpp"

namespace splinecast::apps {
namespace {

constexpr Time kSlice = std::chrono::milliseconds(50);

}  // namespace

EmbeddedSolver::EmbeddedSolver(const ReplayOptions& options, std::function<void()> after_step)
    : solver_(options.embedded
                  ? std::optional<Solver>(std::in_place, options.stream, options.solver)
                  : std::nullopt),
      after_step_(std::move(after_step)) {}

void EmbeddedSolver::solve() {
  if (!solver_) return;
  solver_->attach();
  while (solver_->step(clock_).consumed > 0) after_step_();
}

bool EmbeddedSolver::wait_until(Time instant) {
  if (!solver_) return sleep_until(instant);
  for (Time now = clock_.now(); now < instant; now = clock_.now()) {
    if (stop_requested()) return false;
    solve();
    solver_->wait(instant - now);
  }
  return !stop_requested();
}

Time EmbeddedSolver::slice() const {
  if (!solver_) return kSlice;
  return std::clamp(solver_->due() - clock_.now(), Time::zero(), kSlice);
}

}  // namespace splinecast::apps
