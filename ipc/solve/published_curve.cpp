#include "ipc/solve/published_curve.hpp"

#include <algorithm>
#include <utility>

#include "ipc/board/reader.hpp"
#include "ipc/board/writer.hpp"
#include "ipc/layout/summary.hpp"

namespace splinecast::ipc {

PublishedCurve::PublishedCurve(KnotBoardWriter& board, const KnotBoardReader& published,
                               const core::WindowOptions& options, const DimensionKinds& kinds,
                               const EntryOptions& entries)
    : published_(&published),
      plan_(published.dimensions(), core::with_kinds(options, kinds), entries.keeps_limits),
      writer_(board, published, *options.interpolant.method),
      plan_reader_(published, plan_.window()),
      search_(published.dimensions(), core::with_kinds(options, kinds), entries),
      cut_(board, published, kinds, window().limits_at_largest_rate()),
      slowed_(published, kinds),
      shown_(published),
      read_(published.dimensions(), published.smooths()),
      segment_(published.dimensions()) {}

void PublishedCurve::restore(const Summary& summary) noexcept {
  is_prepared_ = false;
  end_search_.reset();
  leaving_item_.reset();
  if (summary.revision == 0) shown_.begin_stream();
  summary_ = summary;
  const bool is_readable = summary.newest == 0 || read_.take_last(*published_, summary_);
  const Time rest = is_readable && summary.newest > 0 ? read_.right() : Time{};
  is_damaged_ = !is_readable || (!summary.finished && !plan_reader_.read(summary));
  if (is_damaged_ || summary.finished) {
    plan_.restore({}, {});
    writer_.restore(plan_, summary, rest, {});
  } else {
    plan_.restore(plan_reader_.state(), plan_reader_.knots());
    writer_.restore(plan_, summary, rest, plan_reader_.origin());
  }
  search_.restart(plan_);
  shown_.discarded();
  shown_.forget_after(plan_.newest_time());
}

void PublishedCurve::freeze(Time t) noexcept {
  is_prepared_ = false;
  switch (plan_.freeze(t)) {
    case core::Plan::Frozen::left_target:
      writer_.left_target(plan_);
      break;
    case core::Plan::Frozen::searches_again:
      search_.restart(plan_);
      break;
    case core::Plan::Frozen::nothing_to_do:
      break;
  }
  writer_.keep_settled(plan_);
}

bool PublishedCurve::has_room_to_cut(Time t, std::size_t knots, Time keep) const noexcept {
  return writer_.has_room_after(segment_at(*published_, summary_, t), knots, keep);
}

/// Whether there is room for the cut, the entry, the piece of the target that is still in the
/// window, and a stop.
bool PublishedCurve::has_room_to_enter(Time keep) const noexcept {
  const std::size_t added = window().knots() - window().oldest_segment() + 3 + kAddedByStop;
  return writer_.newest() == 0 || writer_.has_room_after(writer_.newest(), added, keep);
}

Time PublishedCurve::earliest_cut() const noexcept {
  Time left{};
  core::SegmentForm form{};
  const Word first = writer_.first();
  if (writer_.newest() == 0 || !published_->copy_time(first, summary_.revision, left, form)) {
    return Time::max();
  }
  const bool is_held =
      first == 1 && !window().is_later_run() && window().options().held_before_start;
  return is_held ? Time::min() : left;
}

void PublishedCurve::begin(const Instant& state) noexcept {
  plan_.begin(state);
  writer_.begun(plan_);
}

void PublishedCurve::begin_run(Time t, const RunBegin& how) noexcept {
  if (!find_cut(t)) return;
  if (how.is_from_rest) cut_.come_to_rest();
  if (!find_reach(Time::max())) return;
  cut_.write();
  plan_.cut(cut_.state(), how.blend);
  writer_.cut(plan_, {.number = cut_.next(),
                      .is_new = true,
                      .is_corner = how.is_from_rest,
                      .stopped_by = how.stopped_by});
  is_prepared_ = false;
  end_search_.reset();
  shown_.begin_cut();
  if (how.has_waypoints) {
    shown_.replace_from_next();
  } else {
    shown_.forget_after(t - Time(1));
  }
}

PublishedCurve::NewOrigin PublishedCurve::write_cut() noexcept {
  if (!uses_cut_) return {};
  cut_.write();
  return {cut_.state(), cut_.next()};
}

void PublishedCurve::append(const Waypoint& waypoint, Word item) noexcept {
  const bool begins_search = plan_.append(waypoint);
  if (is_live()) shown_.note(waypoint.time, waypoint.position);
  if (begins_search) search_.restart(plan_);
  writer_.appended(plan_, item);
}

Word PublishedCurve::waypoints_after(Time t) const noexcept {
  if (!is_on_target()) return 0;
  return std::min<Word>(writer_.newest() - segment_at(*published_, summary_, t),
                        window().knots() - plan_.met());
}

Time PublishedCurve::write() noexcept {
  const auto changed_from = writer_.write(plan_, slowed_);
  is_damaged_ = is_damaged_ || !changed_from;
  return changed_from.value_or(Time::max());
}

RunProgress PublishedCurve::progress() const noexcept {
  const auto* const ahead = std::get_if<core::EnteringAhead>(&plan_.end());
  return {.course = course_of(plan_.end()),
          .knots = window().knots(),
          .met = plan_.met(),
          .unmet = plan_.unmet(),
          .goal = ahead != nullptr && ahead->ends_at_known ? ahead->known : 0};
}

void PublishedCurve::committed(const Summary& summary) noexcept {
  shown_.committed();
  is_prepared_ = false;  // the reach of an entry is that of the committed curve
  summary_ = summary;
  writer_.committed(plan_);
}

}  // namespace splinecast::ipc
