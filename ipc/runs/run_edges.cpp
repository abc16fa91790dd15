#include "ipc/runs/run_edges.hpp"

#include <algorithm>

namespace splinecast::ipc {

void evaluate_at_cut(const CutSegment& segment, Time t, State& out) noexcept {
  const Time at = std::clamp(t, segment.left, segment.right);
  core::evaluate(segment.order, segment.coefficients, to_seconds(at - segment.left), out.ref());
  if (t >= segment.left && t < segment.right) return;
  come_to_rest(out);
}

void come_to_rest(State& state) noexcept {
  std::ranges::fill(state.ref().velocity, 0.0);
  std::ranges::fill(state.ref().acceleration, 0.0);
}

}  // namespace splinecast::ipc
