#include "apps/record/executed/executed_curve.hpp"

#include <algorithm>
#include <utility>

#include "ipc/options/stream.hpp"
#include "splinecast/clock.hpp"

namespace splinecast::apps::record {
namespace {

ipc::SegmentView view_of(const ipc::SegmentCopy& segment) noexcept {
  return {.left = segment.left,
          .right = segment.right,
          .order = segment.order,
          .kind = segment.kind,
          .coefficients = segment.coefficients};
}

/// Appends a segment, or begins another part with it after a gap.
void append(const ipc::SegmentCopy& segment, Time right, std::vector<PiecewisePolynomial>& parts) {
  const std::size_t dimensions =
      segment.coefficients.size() / static_cast<std::size_t>(segment.order);
  const bool continues = !parts.empty() && parts.back().breaks().back() == segment.left;
  if (right == segment.left && continues) return;
  if (!continues || parts.back().is_hold()) parts.emplace_back(dimensions);
  parts.back().append(segment.left, right, segment.order, segment.coefficients);
}

}  // namespace

ExecutedCurve::ExecutedCurve(StreamOptions options)
    : options_(std::move(options)),
      kinds_(ipc::dimension_kinds(*options_.spline)),
      is_live_(is_live(ipc::stream_clock(*options_.spline))) {}

void ExecutedCurve::take(ipc::SegmentCopy segment) {
  while (!segments_.empty() && segments_.back().left >= segment.left) segments_.pop_back();
  segments_.push_back(std::move(segment));
}

void ExecutedCurve::take(Published published, Time host) {
  published_ = std::move(published);
  if (published_.summary.finished && !finished_since_) finished_since_ = host;
  if (!published_.summary.finished) finished_since_.reset();
}

const ipc::OpenSegment* ExecutedCurve::open() const noexcept {
  if (!published_.open) return nullptr;
  const ipc::OpenSegment& open = *published_.open;
  const bool is_after = segments_.empty() || open.segment.left >= segments_.back().right;
  return is_after ? &open : nullptr;
}

Time ExecutedCurve::begin() const noexcept {
  return segments_.empty() ? open()->segment.left : segments_.front().left;
}

SampleStatus ExecutedCurve::status_in(const ipc::SegmentView& segment, Time host) const noexcept {
  const bool is_finished = finished_since_ && (!is_live_ || host >= *finished_since_);
  if (is_finished) return SampleStatus::settled;
  if (segment.kind == SegmentKind::hold) return SampleStatus::holding;
  return segment.kind == SegmentKind::stop ? SampleStatus::stopping : SampleStatus::settled;
}

ExecutedSample ExecutedCurve::sample(Time t, double fraction, Time host,
                                     const StateRef& out) const noexcept {
  const ipc::OpenSegment* const next = open();
  const bool is_open = next != nullptr && t >= next->segment.left;
  if (is_open && t >= next->until) return {.status = SampleStatus::no_data};
  const auto after = std::ranges::upper_bound(segments_, t, {}, &ipc::SegmentCopy::left);
  if (!is_open && after == segments_.begin()) {
    const ipc::SegmentCopy* const first = !segments_.empty() ? &segments_.front()
                                          : next != nullptr  ? &next->segment
                                                             : nullptr;
    const bool holds = is_live_ && first != nullptr && first->number == 1;
    if (!holds) return {.status = SampleStatus::before_history};
    if (!ipc::values_before(view_of(*first), kinds_, out)) return {.status = SampleStatus::no_data};
    return {.status = SampleStatus::holding, .kind = SegmentKind::hold};
  }
  const ipc::SegmentView found = view_of(is_open ? next->segment : *std::prev(after));
  if (t >= found.right) {
    if (after != segments_.end()) return {.status = SampleStatus::no_data};  // a gap
    return sample_last(t, found, out);
  }
  ipc::values_at(found, kinds_, t, fraction, out);
  return {.status = status_in(found, host), .kind = found.kind};
}

/// At or after the end of the last segment: the values at which the curve rests from then on.
ExecutedSample ExecutedCurve::sample_last(Time t, const ipc::SegmentView& last,
                                          const StateRef& out) const noexcept {
  const ipc::Summary& summary = published_.summary;
  const ipc::SegmentCopy& own = segments_.back();
  const bool is_newest =
      summary.finished ? own.next >= summary.newest : own.number == summary.newest;
  const bool rests = summary.finished || t < summary.settled_until;
  if (!is_newest || !rests) return {.status = SampleStatus::no_data};
  ipc::values_at(last, kinds_, t, 0, out);
  const bool is_end = summary.finished && t == last.right;
  return {.status = is_end ? SampleStatus::settled : SampleStatus::holding,
          .kind = is_end ? last.kind : SegmentKind::hold};
}

std::vector<PiecewisePolynomial> ExecutedCurve::parts() const {
  std::vector<PiecewisePolynomial> parts;
  for (const ipc::SegmentCopy& segment : segments_) append(segment, segment.right, parts);
  if (const ipc::OpenSegment* const next = open()) append(next->segment, next->until, parts);
  return parts;
}

std::optional<ipc::LawPoint> law_point(const ExecutedCurve& law, Time host) noexcept {
  std::array<double, 4> values{};
  const std::span all(values);
  const StateRef out{.position = all.subspan(0, 1),
                     .velocity = all.subspan(1, 1),
                     .acceleration = all.subspan(2, 1),
                     .jerk = all.subspan(3, 1)};
  if (!has_values(law.sample(host, 0, host, out).status)) return std::nullopt;
  return ipc::point_of(law.header(), values[0],
                       {.rate = values[1], .slope = values[2], .curvature = values[3]});
}

}  // namespace splinecast::apps::record
