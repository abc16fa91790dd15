#include "apps/trials/curve_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/polynomial/segment.hpp"

namespace splinecast::apps {
namespace {

/// Raises a maximum to |value|; NaN raises it to infinity.
void raise(double& most, double value) {
  most =
      std::isnan(value) ? std::numeric_limits<double>::infinity() : std::max(most, std::abs(value));
}

/// Steps below these are rounding, in rad, rad/s and rad/s².
constexpr double kPositionRounding = 1e-10;
constexpr double kVelocityRounding = 1e-8;
constexpr double kAccelerationRounding = 1e-4;

}  // namespace

bool is_sound(const WatchReport& report) noexcept {
  return report.changed == 0 && report.position_step < kPositionRounding &&
         report.velocity_step < kVelocityRounding &&
         report.unpublished_step < kAccelerationRounding;
}

CurveWatch::CurveWatch(ipc::Sampler& sampler, std::size_t dimensions)
    : sampler_(&sampler),
      now_(dimensions),
      left_(dimensions),
      right_(dimensions),
      snapshot_(dimensions),
      seen_(kKept) {
  for (Seen& seen : seen_) seen.values.resize(4 * dimensions);
}

SampleStatus CurveWatch::tick(Time now) {
  const SampleStatus status = sampler_->sample(now, now_.ref());
  ++report_.samples;
  ++report_.by_status[static_cast<std::size_t>(status)];
  if (!has_values(status)) {
    ticks_ = 0;
    return status;
  }
  // A curve at rest counts as settled: no part of it can change.
  const bool is_settled = status == SampleStatus::settled || status == SampleStatus::holding ||
                          now < sampler_->settled_until();
  if (!is_settled) ++report_.unsettled;
  for (const double a : now_.acceleration()) raise(report_.acceleration, a);
  if (status == SampleStatus::revised) ticks_ = 0;
  if (ticks_ > 0) {
    check_joins(seen_[(ticks_ - 1) % kKept].time, now);
    read_again(1);
    // Also reads one older sample. Steps of 37, a prime, visit all kept samples in turn.
    read_again(1 + report_.samples * 37 % std::min(ticks_, kKept));
  }
  Seen& seen = seen_[ticks_++ % kKept];
  seen.time = now;
  std::ranges::copy(now_.values(), seen.values.begin());
  return status;
}

void CurveWatch::read_again(std::size_t back) {
  const Seen& seen = seen_[(ticks_ - back) % kKept];
  const auto status = sampler_->preview(seen.time, left_.ref());
  if (!has_values(status)) return;
  if (!std::ranges::equal(left_.values(), seen.values)) ++report_.changed;
}

void CurveWatch::check_joins(Time from, Time to) {
  if (!has_values(sampler_->snapshot(from, to, snapshot_))) return;
  const auto segments = snapshot_.segments();
  for (std::size_t i = 1; i < segments.size(); ++i) check_join(segments[i - 1], segments[i]);
}

/// As readers see it, but without wrapping periodic dimensions, which would step by a period.
void CurveWatch::evaluate(const ipc::SegmentCopy& segment, double u, State& out) const {
  const StateRef ref = out.ref();
  core::evaluate(segment.order, segment.coefficients, u, ref);
  sampler_->kinds().normalise_quaternions(ref.position, ref.velocity, ref.acceleration);
}

void CurveWatch::check_join(const ipc::SegmentCopy& before, const ipc::SegmentCopy& after) {
  evaluate(before, to_seconds(before.right - before.left), left_);
  evaluate(after, 0, right_);
  ++report_.knots;
  for (std::size_t d = 0; d < now_.dimensions(); ++d) {
    const double step = right_.acceleration()[d] - left_.acceleration()[d];
    raise(report_.position_step, right_.position()[d] - left_.position()[d]);
    raise(report_.velocity_step, right_.velocity()[d] - left_.velocity()[d]);
    raise(report_.unpublished_step, step - after.acceleration_step[d]);
    raise(report_.acceleration_step, after.acceleration_step[d]);
  }
}

}  // namespace splinecast::apps
