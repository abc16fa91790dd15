#include "ipc/verification/begin_state.hpp"

#include <algorithm>
#include <cmath>

#include "core/limits/for_all.hpp"
#include "core/polynomial/segment.hpp"
#include "ipc/ring/item.hpp"
#include "ipc/verification/difference.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::ipc {
namespace {

/// Maximum number of normalisations to try: each run that replaced another one at the same state
/// has normalised it once more.
constexpr int kNormalisations = 4;

}  // namespace

void BeginState::find(std::size_t i, Time natural_right) noexcept {
  const SegmentCopy& segment = segments_[i];
  if (i == 0) {
    const auto start = record_.items.find(ItemKind::start_state, 0, record_.items.size());
    if (!start) return take_state_of(segment);
    take_item(*start);
    if (is_decided(segment)) take_acceleration_of(segment);
    return;
  }
  const bool begins_on_knot =
      segment.left == natural_right &&
      (segments_[i - 1].kind == SegmentKind::spline || segments_[i - 1].kind == SegmentKind::entry);
  if (begins_on_knot) return take_state_of(segment);
  CutSegment cut = cut_of(segments_[i - 1]);
  cut.right = natural_right;
  evaluate_at_cut(cut, segment.left, state_);
  if (segment.is_corner) come_to_rest(state_);
  normalise();
  for (int n = 1; n < kNormalisations && !is_state_of(segment); ++n) normalise();
  if (is_decided(segment)) take_acceleration_of(segment);
}

/// Whether the acceleration with which a segment begins is a decision of the solver.
bool BeginState::is_decided(const SegmentCopy& segment) const noexcept {
  return segment.kind == SegmentKind::entry && segment.order == kMaxOrder &&
         record_.rules != kFormerRules;
}

/// Replaces the acceleration by that of a recorded segment, if that is one that a solver may
/// decide: in each dimension between 0 and that of the motion; of a quaternion, none longer.
void BeginState::take_acceleration_of(const SegmentCopy& segment) noexcept {
  constexpr double kSlack = 1 + 1e-9;
  const std::size_t dimensions = record_.items.dimensions();
  const auto own = state_.ref().acceleration;
  const auto recorded = [&](std::size_t d) { return 2 * segment.coefficients[2 * dimensions + d]; };
  const auto is_between = [&](std::size_t d) {
    return own[d] * recorded(d) >= 0 && std::abs(recorded(d)) <= std::abs(own[d]);
  };
  const auto is_shorter = [&](const QuaternionDimensions& q) {
    double size = 0;
    double own_size = 0;
    for (std::size_t d = q.first; d < q.first + kQuaternionSize; ++d) {
      size = std::hypot(size, recorded(d));
      own_size = std::hypot(own_size, own[d]);
    }
    return size <= own_size * kSlack;
  };
  if (!core::for_all(record_.kinds.quaternions(), dimensions, is_between, is_shorter)) return;
  for (std::size_t d = 0; d < dimensions; ++d) own[d] = recorded(d);
}

void BeginState::take_cut(std::size_t i, Time t) noexcept {
  evaluate_at_cut(cut_of(segments_[i]), t, state_);
}

void BeginState::normalise() noexcept {
  const StateRef state = state_.ref();
  record_.kinds.normalise_quaternions(state.position, state.velocity, state.acceleration);
}

void BeginState::take_item(Word item) noexcept {
  const Waypoint start = record_.items.waypoint(item);
  std::ranges::copy(start.position, state_.ref().position.begin());
  std::ranges::copy(start.velocity, state_.ref().velocity.begin());
  std::ranges::copy(start.acceleration, state_.ref().acceleration.begin());
}

void BeginState::take_state_of(const SegmentCopy& segment) noexcept {
  core::evaluate(segment.order, segment.coefficients, 0, state_.ref());
  // Evaluation makes a negative 0 positive.
  std::ranges::copy(std::span(segment.coefficients).first(record_.items.dimensions()),
                    state_.ref().position.begin());
}

bool BeginState::is_state_of(const SegmentCopy& segment) noexcept {
  core::evaluate(segment.order, segment.coefficients, 0, recorded_.ref());
  const bool may_step = segment.kind == SegmentKind::stop || is_decided(segment);
  return same_bits(recorded_.position(), state_.position()) &&
         same_bits(recorded_.velocity(), state_.velocity()) &&
         (may_step || same_bits(recorded_.acceleration(), state_.acceleration()));
}

}  // namespace splinecast::ipc
