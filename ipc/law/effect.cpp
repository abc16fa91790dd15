#include "ipc/law/effect.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/forms/entry.hpp"
#include "core/laws/motion.hpp"
#include "core/laws/rate_curve.hpp"
#include "core/limits/check.hpp"
#include "core/polynomial/segment.hpp"
#include "ipc/board/reader.hpp"
#include "ipc/board/segment.hpp"
#include "ipc/law/follower.hpp"
#include "ipc/layout/limits.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/sampling/sampler.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::ipc {
namespace {

Instant instant(const core::LawState& state) noexcept {
  return {.time = state.time,
          .position = {&state.position, 1},
          .velocity = {&state.rate, 1},
          .acceleration = {&state.slope, 1}};
}

/// A law that has a rate from a state on.
class PlannedLaw {
 public:
  PlannedLaw(const core::LawState& from, const core::RateCurve& rate, Time origin)
      : last_(from), origin_(origin) {
    for (const core::RatePiece& piece : rate.pieces()) {
      const core::LawState end = core::end_of_piece(last_, piece.end_rate, piece.length);
      core::build_entry(instant(last_), instant(end), parts_.emplace_back(1));
      last_ = end;
    }
  }

  /// The law at a time that is not before that state.
  [[nodiscard]] LawPoint at(Time host) noexcept {
    const auto part = std::ranges::find_if(
        parts_, [host](const core::Segment& segment) { return host < segment.right; });
    if (part == parts_.end()) {
      const double s = last_.position + last_.rate * to_seconds(host - last_.time);
      return point_at(s, origin_, {.rate = last_.rate});
    }
    core::evaluate(part->order, part->coefficients, to_seconds(host - part->left), state_.ref());
    return point_at(state_.position()[0], origin_,
                    {.rate = state_.velocity()[0],
                     .slope = state_.acceleration()[0],
                     .curvature = state_.jerk()[0]});
  }

 private:
  std::vector<core::Segment> parts_;
  core::LawState last_;
  Time origin_;
  State state_{1};
};

void raise(std::vector<double>& peaks, std::span<const double> values) noexcept {
  for (std::size_t d = 0; d < values.size(); ++d) {
    peaks[d] = std::max(peaks[d], std::abs(values[d]));
  }
}

}  // namespace

std::vector<std::string> followers_of(std::uint64_t law_id, const Trust& trust) {
  std::vector<std::string> found = stream_names();
  std::erase_if(found, [&](const std::string& stream) {
    try {
      const auto header = peek_header(stream, RegionKind::spline, trust);
      return !header || header->law_id != law_id;
    } catch (const StreamError&) {
      return true;
    }
  });
  return found;
}

RampEffect effect_of(const std::string& stream, const core::LawState& from,
                     const core::RateCurve& rate, Time origin, Time longest, const Trust& trust) {
  constexpr Time kStep = std::chrono::milliseconds(1);
  const auto [region, header, layout] = open_board(stream, false, trust);
  const KnotBoardReader board(region.bytes(), layout);
  const DimensionKinds kinds = dimension_kinds(header);
  const MotionLimits limits = motion_limits(header);
  Sampler sampler(board, StreamClock::monotonic, kinds);
  PlannedLaw law(from, rate, origin);
  State state(header.dimensions);
  RampEffect effect{.stream = stream,
                    .names = dimension_names(header),
                    .velocity = std::vector<double>(header.dimensions),
                    .acceleration = std::vector<double>(header.dimensions),
                    .jerk = std::vector<double>(header.dimensions)};
  effect.worst.ratio = -1;
  for (Time t = from.time; t <= saturated_sum(from.time, longest); t += kStep) {
    const LawPoint point = law.at(t);
    const SampleStatus status = sampler.preview(point.stream, point.fraction, state.ref());
    if (!has_values(status)) break;
    core::follow(point.rates, state.ref());
    raise(effect.velocity, state.velocity());
    raise(effect.acceleration, state.acceleration());
    raise(effect.jerk, state.jerk());
    const Excess excess = core::worst_excess(limits, &kinds, state);
    if (excess.ratio > effect.worst.ratio) effect.worst = excess;
    const bool is_over = status == SampleStatus::holding || point.rates.rate == 0;
    if (is_over && t > rate.end()) break;
  }
  return effect;
}

}  // namespace splinecast::ipc
