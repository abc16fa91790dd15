#include "apps/record/watch/board_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "apps/record/format/json.hpp"
#include "apps/record/watch/events.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "ipc/owned/stoppers.hpp"

namespace splinecast::apps::record {
namespace {

/// Time between two places from which the rest of the record can be verified.
constexpr Time kStartInterval = std::chrono::seconds(1);
/// Time between two summaries of a stream that runs.
constexpr Time kSummaryInterval = std::chrono::seconds(1);

bool is_same(const ipc::Look& a, const ipc::Look& b) noexcept {
  return a.revision == b.revision && a.settled_until == b.settled_until;
}

}  // namespace

BoardWatch::BoardWatch(std::uint32_t number, ipc::CheckedRegion<ipc::BoardLayout> board,
                       RingWatch& ring, const StreamTimes& times)
    : number_(number),
      board_(std::move(board)),
      reader_(board_.region.bytes(), board_.layout),
      ring_(ring),
      times_(times),
      options_(ipc::window_options(board_.header)),
      settled_(reader_, is_live(ipc::stream_clock(board_.header))),
      excesses_(options_, ipc::dimension_kinds(board_.header)),
      refused_(ipc::kRefusalsKept) {
  board_.region.close_descriptor();
}

bool BoardWatch::calls() const noexcept {
  return !is_same(reader_.look(), looked_) || settled_.waits() || reader_.retired();
}

Record BoardWatch::record(RecordKind kind, ipc::Word number, Time own_time, Bytes bytes) const {
  return {.stream = number_,
          .kind = kind,
          .number = number,
          .own_time = own_time,
          .bytes = std::move(bytes)};
}

Time BoardWatch::event_time(const Batch& batch) const noexcept {
  return times_.stream_time(batch.now, summary_.newest_time);
}

void BoardWatch::look(Batch& batch) {
  ipc::LawFollower* const law = times_.law();
  const Time final_until = law != nullptr ? law->final_until(MonotonicClock().now()) : Time::max();
  looked_ = reader_.look();
  settled_.look(final_until);
  // Items after the board: the record then has every item that the segments depend on.
  if (ring_.look(batch)) needs_start_ = true;
  put_refusals(batch);
  put_counts(batch);
  put_excesses(batch);
  put_following(batch);
  put_stops(batch);
  const bool was_finished = is_finished_;
  summary_ = settled_.summary();
  put_segments(batch);
  is_finished_ = summary_.finished && settled_.next() >= summary_.newest;
  if (is_finished_ && !was_finished) {
    put_summary(batch);
    put_settled_excesses(batch, excesses_.finish());
    put_event(batch, EventKind::finished, fmt::format(R"("count":{})", summary_.interpolated()));
  } else if (batch.now - kSummaryInterval >= last_summary_) {
    put_summary(batch);
  }
}

void BoardWatch::look_back(Batch& batch) {
  looks_back_ = true;
  look(batch);
  looks_back_ = false;
}

void BoardWatch::put_summary(Batch& batch) {
  last_summary_ = batch.now;
  if (summary_.revision == 0) return;
  batch.add(record(RecordKind::summary, summary_.revision, batch.now,
                   encode(Published{.summary = summary_, .open = settled_.open()})));
}

void BoardWatch::put_event(Batch& batch, EventKind kind, const std::string& members) const {
  add_event(batch, {.stream = number_, .kind = kind, .is_old = looks_back_}, event_time(batch),
            batch.now, members);
}

void BoardWatch::put_loss(Batch& batch, const Loss& loss) const {
  add_loss(batch, number_, loss, event_time(batch));
}

void BoardWatch::put_refusals(Batch& batch) {
  const ipc::Summary& now = settled_.summary();
  if (now.refused == summary_.refused) return;
  const std::size_t count = reader_.copy_refusals(now, summary_.refused, refused_);
  const ipc::Word missed = now.refused - summary_.refused - count;
  if (missed > 0) {
    // Which items were refused before the oldest one of these is unknown.
    ring_.set_incomplete_before(count > 0 ? refused_[0].item + 1 : now.consumed);
    needs_start_ = true;
    put_loss(batch, {.cause = cause(), .refusals = missed});
  }
  for (const ipc::RefusalRecord& refused : std::span(refused_).first(count)) {
    ring_.note_refused(refused.item);
    batch.add(record(RecordKind::refusal, refused.item, batch.now, encode(refused)));
    put_event(batch, EventKind::refusal,
              fmt::format(R"("item":{},"reason":"{}")", refused.item, to_string(refused.reason)));
  }
}

/// Writes an event for each counter of the summary that has risen.
void BoardWatch::put_counts(Batch& batch) {
  const ipc::Summary& now = settled_.summary();
  const auto look_at = [&](EventKind kind, ipc::Word ipc::Summary::*counter) {
    if (now.*counter <= summary_.*counter) return;
    put_event(batch, kind, fmt::format(R"("count":{})", now.*counter));
  };
  look_at(EventKind::underrun, &ipc::Summary::underruns);
  look_at(EventKind::deadline, &ipc::Summary::deadline_misses);
  look_at(EventKind::late, &ipc::Summary::late_commits);
  if (now.late_commits <= summary_.late_commits) return;
  // Segments that have been read may have been changed.
  needs_start_ = true;
  put_loss(batch, {.cause = LossCause::late_commit});
}

void BoardWatch::put_excesses(Batch& batch) {
  const ipc::Summary& now = settled_.summary();
  if (now.exceeding == summary_.exceeding) return;
  const ipc::Word kept = std::min<ipc::Word>(now.exceeding, ipc::kExcessesKept);
  const auto names = ipc::dimension_names(board_.header);
  const ipc::Word first = std::max(summary_.exceeding, now.exceeding - kept);
  ipc::Word missed = first - std::min(first, summary_.exceeding);
  for (ipc::Word i = first; i < now.exceeding; ++i) {
    const auto excess = reader_.excess(now, i);
    if (!excess) {
      ++missed;
      continue;
    }
    put_event(batch, EventKind::limit, members_of(*excess, names));
    if (excess->is_refused) continue;
    if (const auto dropped = excesses_.add(*excess)) put_settled_excesses(batch, {*dropped});
  }
  // The board keeps the newest ones only.
  if (missed > 0) put_event(batch, EventKind::limit, fmt::format(R"("missed":{})", missed));
}

void BoardWatch::put_settled_excesses(Batch& batch,
                                      const std::vector<SettledExcess>& settled) const {
  if (settled.empty()) return;
  const auto names = ipc::dimension_names(board_.header);
  for (const SettledExcess& excess : settled) {
    put_event(batch, EventKind::limit_settled, members_of(excess, names));
  }
}

/// Writes an event when the curve begins or ceases to follow its waypoints.
void BoardWatch::put_following(Batch& batch) {
  const ipc::Following now = settled_.summary().following();
  if (now == summary_.following()) return;
  put_event(batch, EventKind::following, fmt::format(R"("state":"{}")", ipc::to_string(now)));
}

/// Writes an event for each request of a stopper that is in force now.
void BoardWatch::put_stops(Batch& batch) {
  if (settled_.summary().revision == summary_.revision) return;
  for (const ipc::StopperEntry& stopper : ipc::stoppers_of(reader_)) {
    const auto [last, is_new] = stops_.try_emplace(stopper.id, stopper.number);
    if (!is_new && std::exchange(last->second, stopper.number) == stopper.number) continue;
    put_event(batch, stopper.holds ? EventKind::stopped : EventKind::released,
              fmt::format(R"("stopper":{},"request":{})", json_text(stopper.name), stopper.number));
  }
}

bool BoardWatch::wants_start(const Batch& batch) const noexcept {
  return needs_start_ || batch.now - kStartInterval >= last_start_;
}

void BoardWatch::put_segments(Batch& batch) {
  const auto segments = settled_.segments();
  if (segments.empty()) return;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const ipc::SegmentCopy& segment = segments[i];
    const ipc::SegmentCopy* before = i > 0 ? &segments[i - 1] : has_last_ ? &last_ : nullptr;
    const ipc::Word expected = before != nullptr ? before->next : 1;
    if (segment.number != expected) {
      needs_start_ = true;
      put_loss(batch, {.cause = has_last_ ? LossCause::overwritten : LossCause::before,
                       .segments = {.first = expected, .count = segment.number - expected}});
      before = nullptr;
    }
    if (before == nullptr && segment.number == 1 && ring_.complete_from() > 0) needs_start_ = true;
    put_segment(batch, before, segment);
  }
  last_ = segments.back();
  has_last_ = true;
  if (wants_start(batch)) try_restart(batch, last_);
  settled_.drop();
}

void BoardWatch::put_segment(Batch& batch, const ipc::SegmentCopy* before,
                             const ipc::SegmentCopy& segment) {
  // At the first look, and after a loss, the board may still have the knots before this segment.
  if (needs_start_ && before != nullptr) try_restart(batch, *before);
  const bool is_start = starts_.take(before, segment);
  if (is_start && wants_start(batch) && ring_.complete_from() <= *segment.origin.item) {
    put_restart(batch, {.before = *before, .first_item = *segment.origin.item});
  }
  if (is_start) ring_.forget_before(*segment.origin.item);
  batch.add(record(RecordKind::segment, segment.number, times_.wall_time(segment.left, batch.now),
                   encode(segment)));
  batch.records.back().next = std::max(segment.next, segment.number + 1);
  batch.records.back().own_end = times_.wall_time(segment.right, batch.now);
  put_settled_excesses(batch, excesses_.take(segment));
  put_return(batch, before, segment);
}

/// Writes an event when the curve meets a waypoint again.
void BoardWatch::put_return(Batch& batch, const ipc::SegmentCopy* before,
                            const ipc::SegmentCopy& segment) {
  const auto found = returns_.take(before, segment);
  if (!found) return;
  std::string members;
  if (found->away) members = fmt::format(R"("away_ns":{})", found->away->count());
  if (const auto item = ring_.waypoint_at(found->run_item, found->time)) {
    members += fmt::format(R"({}"item":{})", members.empty() ? "" : ",", *item);
  }
  add_event(batch, {.stream = number_, .kind = EventKind::returned, .is_old = looks_back_},
            found->time, times_.wall_time(found->time, batch.now), members);
}

void BoardWatch::put_restart(Batch& batch, Restart restart) {
  needs_start_ = false;
  last_start_ = batch.now;
  batch.add(record(RecordKind::restart, restart.first_item,
                   times_.wall_time(restart.before.right, batch.now), encode(restart)));
}

/// Writes the knots up to the end of a settled segment, if the board has them.
void BoardWatch::try_restart(Batch& batch, const ipc::SegmentCopy& before) {
  auto knots = ipc::copy_restart(reader_, summary_, options_, before.next);
  if (!knots) return;
  const auto first = ring_.first_after(knots->run_item, knots->knots.back().time);
  if (!first) return;
  starts_.continue_run(knots->run_item);
  put_restart(batch, {.before = before, .first_item = *first, .knots = std::move(knots)});
}

}  // namespace splinecast::apps::record
