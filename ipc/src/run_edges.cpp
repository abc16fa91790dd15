#include "splinecast/ipc/run_edges.hpp"

#include <algorithm>

#include "splinecast/core/limits.hpp"
#include "splinecast/core/splice.hpp"

namespace splinecast::ipc {

void evaluate_at_cut(const CutSegment& segment, core::Time t, core::State& out) noexcept {
  const core::Time at = std::clamp(t, segment.left, segment.right);
  core::evaluate(segment.order, segment.coefficients, core::to_seconds(at - segment.left),
                 out.ref());
  if (t >= segment.left && t < segment.right) return;
  std::ranges::fill(out.ref().velocity, 0.0);
  std::ranges::fill(out.ref().acceleration, 0.0);
}

std::optional<WayBack> way_back(const core::SlidingWindow& window, const core::Knot& knot,
                                core::Segment& scratch, core::State& at_rest) noexcept {
  const std::size_t dimensions = window.dimensions();
  window.segment(window.segments() - 1, scratch);
  core::evaluate(scratch.order, scratch.coefficients,
                 core::to_seconds(scratch.right - scratch.left), at_rest.ref());
  if (std::ranges::equal(at_rest.position(), knot.position)) return std::nullopt;
  std::array<double, core::kMaxDimensions> distance{};
  for (std::size_t d = 0; d < dimensions; ++d) {
    distance[d] = at_rest.position()[d] - knot.position[d];
  }
  const core::WindowOptions& options = window.options();
  const core::Time least = options.stop_time;
  // Without limits a little slower than the stop: the same way at the same peak acceleration.
  const core::Time duration = options.limits.acceleration.empty()
                                  ? least + least / 2
                                  : core::move_time_within(options.limits.acceleration, least,
                                                           std::span(distance).first(dimensions));
  return WayBack{.rest = scratch.right, .duration = duration};
}

void build_way_back(const WayBack& way, core::Time start, std::span<const double> from,
                    std::span<const double> to, core::Segment& out) noexcept {
  constexpr std::array<double, core::kMaxDimensions> kZeros{};
  const auto zeros = std::span(kZeros).first(from.size());
  core::build_splice({start, from, zeros, zeros}, {start + way.duration, to, zeros, zeros}, out);
}

}  // namespace splinecast::ipc
