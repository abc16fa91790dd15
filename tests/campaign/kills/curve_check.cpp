#include "tests/campaign/kills/curve_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "apps/process/messages.hpp"
#include "core/polynomial/segment.hpp"
#include "ipc/roles/internals.hpp"

namespace splinecast::campaign {
namespace {

/// Steps that rounding may cause, with positions near 1, velocities up to 10³/s and accelerations
/// up to 10⁵/s².
constexpr double kPositionRounding = 1e-9;
constexpr double kVelocityRounding = 1e-7;
constexpr double kAccelerationRounding = 1e-3;

bool differ(std::span<const double> a, std::span<const double> b, double rounding) {
  return !std::ranges::equal(
      a, b, [&](double x, double y) { return std::abs(x - y) <= rounding; });  // no NaN is equal
}

}  // namespace

CurveCheck::CurveCheck(const Plan& plan, Reader& reader, ReaderFacts& facts)
    : plan_(&plan),
      reader_(&reader),
      facts_(&facts),
      watch_(ipc::Internals::sampler(reader), reader.dimensions()),
      state_(reader.dimensions()),
      left_(reader.dimensions()),
      right_(reader.dimensions()),
      snapshot_(reader.dimensions()) {}

void CurveCheck::found(std::atomic<std::uint64_t>& counter, const std::string& what) {
  ++counter;
  apps::say(fmt::format("'{}': {}", plan_->stream, what));
}

SampleStatus CurveCheck::tick(Time t) {
  const apps::WatchReport before = watch_.report();
  const SampleStatus status = watch_.tick(t);
  if (status == SampleStatus::busy) ++facts_->busy;
  if (!has_values(status)) return status;
  ++facts_->samples;
  ++facts_->life_samples;
  check_state(watch_.state(), t);
  check_steps(before, t);
  return status;
}

void CurveCheck::check_steps(const apps::WatchReport& before, Time t) {
  const apps::WatchReport& now = watch_.report();
  if (now.changed > before.changed) {
    found(facts_->changed, fmt::format("a settled sample before {} has changed", t.count()));
  }
  const auto grew = [](double value, double old, double rounding) {
    return value > std::max(old, rounding);
  };
  if (grew(now.position_step, before.position_step, kPositionRounding) ||
      grew(now.velocity_step, before.velocity_step, kVelocityRounding) ||
      grew(now.unpublished_step, before.unpublished_step, kAccelerationRounding)) {
    found(facts_->stepped,
          fmt::format("a step before {}: position {}, velocity {}, unpublished acceleration {}",
                      t.count(), now.position_step, now.velocity_step, now.unpublished_step));
  }
}

SampleStatus CurveCheck::peek(Time t) {
  const SampleStatus status = reader_->preview(t, state_);
  if (status == SampleStatus::busy) ++facts_->busy;
  if (!has_values(status)) return status;
  ++facts_->samples;
  ++facts_->life_samples;
  check_state(state_, t);
  return status;
}

void CurveCheck::check_state(const State& state, Time t) {
  if (Payload::is_whole(state.values())) return;
  found(facts_->torn, fmt::format("a sample at {} is torn", t.count()));
}

void CurveCheck::survey(Time from, Time to) {
  if (!has_values(ipc::Internals::sampler(*reader_).snapshot(from, to, snapshot_))) return;
  const auto segments = snapshot_.segments();
  for (std::size_t i = 0; i < segments.size(); ++i) {
    check_segment(segments[i]);
    if (i > 0) check_join(segments[i - 1], segments[i]);
  }
  if (!segments.empty()) check_end(segments.back());
  facts_->segments += segments.size();
}

void CurveCheck::check_segment(const ipc::SegmentCopy& segment) {
  const auto powers = std::span(segment.coefficients)
                          .first(static_cast<std::size_t>(segment.order) * Payload::kDimensions);
  const auto& step = segment.acceleration_step;
  if (!Payload::is_whole(powers) || (!step.empty() && !Payload::is_whole(step))) {
    found(facts_->torn, fmt::format("segment {} is torn", segment.number));
  }
  if (segment.has_waypoint && !begins_at_waypoint(segment)) {
    found(facts_->torn, fmt::format("segment {} begins at {} with another waypoint's position",
                                    segment.number, segment.left.count()));
  }
  check_reference(segment);
}

/// Whether a segment begins with the position of the waypoint of that time; after the first piece
/// of an end that slows down, with that of an earlier waypoint.
bool CurveCheck::begins_at_waypoint(const ipc::SegmentCopy& segment) const {
  const Payload& payload = plan_->payload;
  const auto position = std::span(segment.coefficients).first(Payload::kDimensions);
  const auto is_at = [&](ipc::Word number) {
    return std::ranges::equal(position, payload.position_of(number));
  };
  if (const auto number = payload.number_at(segment.left); number && is_at(*number)) return true;
  if (segment.kind != SegmentKind::slowed) return false;
  constexpr ipc::Word kMost = 1024;  // waypoints of such an end
  const ipc::Word after = payload.number_from(segment.left);
  for (ipc::Word n = 1; n <= std::min(after, kMost); ++n) {
    if (is_at(after - n)) return true;
  }
  return false;
}

/// On a recorded stream segment n begins at waypoint n − 1, regardless of the kills. Once settled,
/// it has the bits of an undisturbed solve.
void CurveCheck::check_reference(const ipc::SegmentCopy& segment) {
  if (plan_->is_live()) return;
  const auto number = plan_->payload.number_at(segment.left);
  if (segment.has_waypoint && (!number || *number + 1 != segment.number)) {
    found(facts_->wrong, fmt::format("segment {} begins at {}: a waypoint is missing",
                                     segment.number, segment.left.count()));
  }
  if (plan_->reference.empty() || segment.right > snapshot_.summary().settled_until) return;
  const bool is_known = segment.number <= plan_->reference.size();
  const core::Segment* const wanted = is_known ? &plan_->reference[segment.number - 1] : nullptr;
  if (!is_known || segment.right != wanted->right || segment.order != wanted->order ||
      !std::ranges::equal(
          std::span(segment.coefficients)
              .first(static_cast<std::size_t>(segment.order) * Payload::kDimensions),
          std::span(wanted->coefficients)
              .first(static_cast<std::size_t>(segment.order) * Payload::kDimensions))) {
    found(facts_->wrong,
          fmt::format("segment {} is settled, but differs from that of an undisturbed solver",
                      segment.number));
  }
}

void CurveCheck::check_join(const ipc::SegmentCopy& before, const ipc::SegmentCopy& after) {
  core::evaluate(before.order, before.coefficients, to_seconds(before.right - before.left),
                 left_.ref());
  core::evaluate(after.order, after.coefficients, 0, right_.ref());
  if (before.right != after.left ||
      differ(left_.position(), right_.position(), kPositionRounding) ||
      differ(left_.velocity(), right_.velocity(), kVelocityRounding)) {
    found(facts_->stepped, fmt::format("segments {} and {} do not join at {}", before.number,
                                       after.number, after.left.count()));
  }
}

/// The newest segment ends at rest, except on a finished recorded stream, which has its own end
/// condition.
void CurveCheck::check_end(const ipc::SegmentCopy& segment) {
  const ipc::Summary& summary = snapshot_.summary();
  if (segment.number != summary.newest || (summary.finished && !plan_->is_live())) return;
  ++facts_->ends;
  core::evaluate(segment.order, segment.coefficients, to_seconds(segment.right - segment.left),
                 right_.ref());
  const std::vector<double> rest(reader_->dimensions());
  if (differ(right_.velocity(), rest, kVelocityRounding) ||
      differ(right_.acceleration(), rest, kAccelerationRounding)) {
    found(facts_->restless, fmt::format("segment {}, the newest, does not rest at its end {}",
                                        segment.number, segment.right.count()));
  }
}

}  // namespace splinecast::campaign
