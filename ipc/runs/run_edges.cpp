#include "ipc/runs/run_edges.hpp"

#include <algorithm>

#include "core/forms/stop.hpp"

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

Time BehindEntry::stop_length() const noexcept {
  return std::max(rest - stop_begin(), core::kLeastStopTime);
}

void BehindEntry::write_line_end(std::span<const double> position, std::span<const double> velocity,
                                 std::span<double> out) const noexcept {
  const double line = to_seconds(line_end - end);
  for (std::size_t d = 0; d < out.size(); ++d) out[d] = position[d] + line * velocity[d];
}

}  // namespace splinecast::ipc
