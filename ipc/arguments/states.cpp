#include "ipc/arguments/states.hpp"

#include <algorithm>

namespace splinecast::ipc {
namespace {

constexpr std::array<const char*, 4> kOut{"out->position", "out->velocity", "out->acceleration",
                                          "out->jerk"};
constexpr std::array<const char*, 4> kSampled{"sampled->position", "sampled->velocity",
                                              "sampled->acceleration", "sampled->jerk"};

std::array<splinecast_output, 4> parts(const splinecast_state& state) noexcept {
  return {state.position, state.velocity, state.acceleration, state.jerk};
}

}  // namespace

StateTarget::StateTarget(const splinecast_state* out, std::size_t dimensions)
    : dimensions_(dimensions) {
  const auto given = parts(*require_pointer(out, "out"));
  for (std::size_t r = 0; r < given.size(); ++r) {
    outputs_[r] = optional_output(given[r], dimensions, kOut[r]);
  }
  ref_ = {target(0), target(1), target(2), target(3)};
}

std::span<double> StateTarget::target(std::size_t derivative) noexcept {
  const Outputs& output = outputs_[derivative];
  if (output.given() && output.is_contiguous()) return output.span();
  return {copies_.data() + derivative * dimensions_, dimensions_};
}

void StateTarget::put() const noexcept {
  for (std::size_t r = 0; r < outputs_.size(); ++r) {
    const Outputs& output = outputs_[r];
    if (!output.given() || output.is_contiguous()) continue;
    for (std::size_t d = 0; d < dimensions_; ++d) output[d] = copies_[r * dimensions_ + d];
  }
}

void read_state(const splinecast_state* sampled, State& to) {
  const auto given = parts(*require_pointer(sampled, "sampled"));
  const StateRef ref = to.ref();
  const std::array<std::span<double>, 4> spans{ref.position, ref.velocity, ref.acceleration,
                                               ref.jerk};
  for (std::size_t r = 0; r < given.size(); ++r) {
    const Outputs values = require_output(given[r], to.dimensions(), kSampled[r]);
    for (std::size_t d = 0; d < values.size(); ++d) spans[r][d] = values[d];
  }
}

}  // namespace splinecast::ipc
