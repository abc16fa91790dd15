#include "ipc/ring/writer.hpp"

#include <algorithm>
#include <bit>
#include <string>

#include "ipc/layout/common_control.hpp"
#include "ipc/ring/item_words.hpp"
#include "ipc/ring/reader.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::ipc {
namespace {

/// Time of a stop if the producer does not know a settled time yet: before the time of any
/// waypoint.
constexpr Time kEarliestStop = -kLatestTime;

bool fits(std::span<const double> values, std::size_t dimensions) noexcept {
  return values.empty() || values.size() == dimensions;
}

}  // namespace

WaypointRingWriter::WaypointRingWriter(std::span<std::byte> region, const RingLayout& layout,
                                       const IntervalRange& intervals)
    : layout_(layout),
      intervals_(intervals),
      control_(words_at(region, layout.control, kRingControlWords)),
      items_(words_at(region, layout.items, layout.capacity * words_per_item(layout))),
      written_(load(control_[kWritten], std::memory_order_relaxed)) {
  // Search backwards for the newest item that bounds the time of the next one. The newest item may
  // be a finish, which does not bound it.
  const WaypointRingReader past(region, layout);
  ends_with_stop_ = written_ > 0 && past.is_stop(written_ - 1);
  bool is_found = false;
  for (Word back = 1; back <= std::min<Word>(written_, layout.capacity) && !is_found; ++back) {
    const ItemKind kind = past.kind(written_ - back);
    finished_ = finished_ || kind == ItemKind::finish;
    is_found = kind != ItemKind::finish;
    last_time_ = past.time(written_ - back);
    has_last_ = is_found && last_time_ != kEarliestStop;
  }
  has_begun_ = written_ > layout_.capacity;
  for (Word i = 0; i < written_ && !has_begun_; ++i) {
    has_begun_ = past.kind(i) != ItemKind::replace && past.kind(i) != ItemKind::finish;
  }
  if (!is_time_in_range(last_time_)) {
    throw BadRegion("the ring's last item has time " + std::to_string(last_time_.count()) +
                    " ns, not within 2^62 ns of 0");
  }
}

AppendStatus WaypointRingWriter::check_form(const Waypoint& waypoint) const noexcept {
  const std::size_t dimensions = layout_.dimensions;
  if (finished_) return AppendStatus::finished;
  if (waypoint.position.size() != dimensions || !fits(waypoint.velocity, dimensions) ||
      !fits(waypoint.acceleration, dimensions)) {
    return AppendStatus::wrong_dimension;
  }
  if (!is_finite(waypoint)) return AppendStatus::not_finite;
  return is_time_in_range(waypoint.time) ? AppendStatus::accepted : AppendStatus::too_far_apart;
}

AppendStatus WaypointRingWriter::check(const Waypoint& waypoint,
                                       const Solved& solved) const noexcept {
  AppendStatus status = check_form(waypoint);
  if (status == AppendStatus::accepted && solved.is_stopped) status = AppendStatus::stopped;
  if (status == AppendStatus::accepted && is_too_far_ahead(waypoint.time, solved)) {
    status = AppendStatus::too_far_ahead;
  }
  if (status == AppendStatus::accepted && has_last_) {
    status = judge_interval(waypoint.time - last_time_, intervals_);
    if (status == AppendStatus::too_far_apart && follows_pause(waypoint.time, solved)) {
      status = AppendStatus::accepted;
    }
  }
  if (status != AppendStatus::accepted) return status;
  if (is_past(waypoint.time, solved)) return AppendStatus::past;
  if (cannot_follow(waypoint.time, solved)) return AppendStatus::cannot_follow;
  return has_room(1, solved, control_reserve(layout_.capacity)) ? AppendStatus::accepted
                                                                : AppendStatus::full;
}

/// Whether a time is beyond the horizon: probably one of another clock, which would be executed
/// years from now, and after which each right time would be out of order. Reads the clock only if
/// the settled time does not suffice.
bool WaypointRingWriter::is_too_far_ahead(Time time, const Solved& solved) noexcept {
  if (!solved.horizon) return false;
  const Time settled = std::max(solved.settled_until, -kLatestTime);
  if (time - settled <= *solved.horizon) return false;
  return time - std::max(settled, solved.clock->now()) > *solved.horizon;
}

/// Whether a waypoint is too late: to be part of the target, or to begin the curve. Reads the clock
/// only for the first waypoint, and if the time is before the settled time.
bool WaypointRingWriter::is_past(Time time, const Solved& solved) const noexcept {
  const bool begins = !has_last_ && solved.horizon;
  if (begins && time < solved.clock->now()) return true;
  if (time >= solved.settled_until) return false;
  return !has_last_ || is_long_past(time, solved);
}

/// Whether a time is more than kMostLate before now and the settled time.
bool WaypointRingWriter::is_long_past(Time time, const Solved& solved) noexcept {
  const bool has_now = solved.clock != nullptr && (time < solved.settled_until || solved.horizon);
  const Time now = has_now ? solved.clock->now() : solved.settled_until;
  return time + kMostLate < std::max(now, solved.settled_until);
}

/// Whether the solver would refuse a waypoint, because its curve cannot follow the waypoints. An
/// item that it has not consumed may be a replacement, which the curve follows again.
bool WaypointRingWriter::cannot_follow(Time time, const Solved& solved) const noexcept {
  return solved.refused_until < Time::max() && time <= solved.refused_until &&
         solved.consumed == written_;
}

/// Whether a waypoint that is more than the longest interval after the newest item is valid because
/// it follows the settled time or now closely enough. So a live stream may continue after a pause
/// of any length: its clock also advances at rest.
bool WaypointRingWriter::follows_pause(Time time, const Solved& solved) const noexcept {
  const auto follows = [&](Time since) {
    return since > last_time_ && time - since <= intervals_.most;
  };
  return follows(solved.settled_until) || (solved.clock != nullptr && follows(solved.clock->now()));
}

/// Counts a refusal. The items before one that is refused because a stopper holds the stream are
/// refused, too: after the release the next waypoint begins a run, and may be earlier than they
/// are.
AppendStatus WaypointRingWriter::refused(AppendStatus status) noexcept {
  if (status == AppendStatus::stopped) has_last_ = false;
  return counted(status);
}

AppendStatus WaypointRingWriter::append(const Waypoint& waypoint, const Solved& solved) noexcept {
  const AppendStatus status = check(waypoint, solved);
  if (status != AppendStatus::accepted) return refused(status);
  put_item(0, static_cast<Word>(ItemKind::waypoint), waypoint);
  publish(1, waypoint.time);
  return status;
}

AppendStatus WaypointRingWriter::check_replacement(Time t, const ReplacementPath& waypoints,
                                                   const Solved& solved,
                                                   Time blend) const noexcept {
  if (waypoints.empty()) return check_stop(t, solved);
  if (finished_) return AppendStatus::finished;
  if (solved.is_stopped) return AppendStatus::stopped;
  const Time earliest = earliest_replacement(solved);
  const bool is_soonest = t == kSoonest;
  const Time from = is_soonest ? std::max(earliest, -kLatestTime) : t;
  if (!is_time_in_range(from) || blend > intervals_.most) return AppendStatus::too_far_apart;
  if (from < earliest) return AppendStatus::too_late;
  const std::size_t items = 1 + waypoints.size();
  if (items + control_reserve(layout_.capacity) > layout_.capacity) return AppendStatus::too_many;
  const AppendStatus status = check_path(from, is_soonest, waypoints, solved);
  if (status != AppendStatus::accepted) return status;
  return has_room(items, solved, control_reserve(layout_.capacity)) ? AppendStatus::accepted
                                                                    : AppendStatus::full;
}

/// Checks the waypoints of a replacement from t on. Those of one as soon as possible may begin
/// before; its t is -kLatestTime if no settled time is known.
AppendStatus WaypointRingWriter::check_path(Time t, bool is_soonest,
                                            const ReplacementPath& waypoints,
                                            const Solved& solved) const noexcept {
  Time before = t;
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const Waypoint waypoint = waypoints[i];
    AppendStatus status = check_form(waypoint);
    if (status == AppendStatus::accepted && is_too_far_ahead(waypoint.time, solved)) {
      status = AppendStatus::too_far_ahead;
    }
    const bool is_begin =
        is_soonest && i == 0 && (t == -kLatestTime || waypoint.time - t < intervals_.least);
    if (status == AppendStatus::accepted && !is_begin) {
      status = judge_interval(waypoint.time - before, intervals_);
    }
    if (status != AppendStatus::accepted) return status;
    before = waypoint.time;
  }
  return before > t ? AppendStatus::accepted : AppendStatus::too_late;
}

Time WaypointRingWriter::earliest_replacement(const Solved& solved) noexcept {
  if (solved.clock == nullptr) return solved.settled_until;
  const Time now = solved.clock->now();
  return std::max(solved.settled_until, solved.clock->latest(now, solved.settle_ahead));
}

AppendStatus WaypointRingWriter::replace_from(Time t, const ReplacementPath& waypoints,
                                              const Solved& solved, Time blend) noexcept {
  if (waypoints.empty()) return counted(stop_from(t, solved));
  const AppendStatus status = check_replacement(t, waypoints, solved, blend);
  if (status != AppendStatus::accepted) return refused(status);
  claim(1 + waypoints.size());
  const Word kind = static_cast<Word>(ItemKind::replace) | waypoints.size() << kCountShift;
  put_item(0, kind, {.time = t == kSoonest ? effect_of_stop(t, solved) : t, .position = {}});
  store(item_words(0)[kItemValues], to_word(std::max(blend, Time::zero())),
        std::memory_order_release);
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    put_item(1 + i, static_cast<Word>(ItemKind::waypoint), waypoints[i]);
  }
  publish(1 + waypoints.size(), waypoints.back().time);
  return status;
}

/// The time at which a stop, or a replacement as soon as possible, takes effect: if t has settled,
/// at the end of the settled part.
Time WaypointRingWriter::effect_of_stop(Time t, const Solved& solved) noexcept {
  return std::max({t, solved.settled_until, kEarliestStop});
}

AppendStatus WaypointRingWriter::check_stop(Time t, const Solved& solved) const noexcept {
  if (finished_) return AppendStatus::finished;
  const Time from = effect_of_stop(t, solved);
  if (!is_time_in_range(from)) return AppendStatus::too_far_apart;
  if (is_too_far_ahead(from, solved)) return AppendStatus::too_far_ahead;
  if (repeats_stop(from, solved)) return AppendStatus::accepted;
  // A stop after the settled time leaves one place free for a stop that takes effect at once, and
  // one for finish; a stop that takes effect at once leaves one for finish.
  const bool is_ahead = from > solved.settled_until;
  const std::size_t others = control_reserve(layout_.capacity) / 2;
  const bool has_place = has_room(1, solved, is_ahead ? others : std::min<std::size_t>(others, 1));
  return has_place ? AppendStatus::accepted : AppendStatus::full;
}

AppendStatus WaypointRingWriter::stop_from(Time t, const Solved& solved) noexcept {
  const AppendStatus status = check_stop(t, solved);
  const Time from = effect_of_stop(t, solved);
  if (status != AppendStatus::accepted || repeats_stop(from, solved)) return status;
  claim(1);
  put_item(0, static_cast<Word>(ItemKind::replace), {.time = from, .position = {}});
  publish(1, from);
  has_last_ = from != kEarliestStop;
  ends_with_stop_ = true;
  return AppendStatus::accepted;
}

/// Whether a stop would change nothing: the newest item is a stop at this time or earlier, and the
/// solver has not consumed it yet.
bool WaypointRingWriter::repeats_stop(Time from, const Solved& solved) const noexcept {
  return ends_with_stop_ && solved.consumed < written_ && from >= last_time_;
}

AppendStatus WaypointRingWriter::start_from(const Instant& state, const Solved& solved) noexcept {
  const Waypoint values{state.time, state.position, state.velocity, state.acceleration};
  AppendStatus status = check_form(values);
  if (status == AppendStatus::accepted && (state.velocity.empty() || state.acceleration.empty())) {
    status = AppendStatus::wrong_dimension;
  }
  if (status == AppendStatus::accepted && has_begun_) status = AppendStatus::already_started;
  if (status == AppendStatus::accepted && solved.is_stopped) status = AppendStatus::stopped;
  if (status == AppendStatus::accepted && is_long_past(state.time, solved)) {
    status = AppendStatus::past;
  }
  if (status == AppendStatus::accepted && is_too_far_ahead(state.time, solved)) {
    status = AppendStatus::too_far_ahead;
  }
  if (status != AppendStatus::accepted) return counted(status);
  put_item(0, static_cast<Word>(ItemKind::start_state), values);
  publish(1, state.time);
  return status;
}

AppendStatus WaypointRingWriter::append_plan(std::span<const core::RatePiece> pieces,
                                             std::uint8_t commander, Word request,
                                             const Solved& solved) noexcept {
  if (!has_room(pieces.size(), solved, 0)) return counted(AppendStatus::full);
  claim(pieces.size());
  const double number = std::bit_cast<double>(request);
  for (Word i = 0; i < pieces.size(); ++i) {
    const core::RatePiece& piece = pieces[i];
    const Word kind = static_cast<Word>(ItemKind::rate) | Word{commander} << kCommanderShift |
                      i << kPlaceShift | (pieces.size() - 1 - i) << kCountShift;
    const double length = to_seconds(piece.length);
    put_item(i, kind,
             {.time = piece.begin,
              .position = std::span(&piece.end_rate, 1),
              .velocity = std::span(&length, 1),
              .acceleration = std::span(&number, 1)});
  }
  publish(pieces.size(), pieces.back().begin);
  return AppendStatus::accepted;
}

AppendStatus WaypointRingWriter::finish(const Condition& end, const Solved& solved) noexcept {
  if (finished_) return AppendStatus::finished;
  if (!has_room(1, solved, 0)) return AppendStatus::full;
  const Word kind = static_cast<Word>(ItemKind::finish) | static_cast<Word>(end.kind)
                                                              << kConditionShift;
  const bool is_velocity = end.kind == ConditionKind::velocity;
  const std::span<const double> value(end.value);
  put_item(0, kind,
           {.time = last_time_,
            .position = {},
            .velocity = is_velocity ? value : std::span<const double>{},
            .acceleration = is_velocity ? std::span<const double>{} : value});
  finished_ = true;
  publish(1, last_time_);
  return AppendStatus::accepted;
}

/// P0: stores for observers where the next `items` items end, before these are written. `claimed`
/// never decreases: an earlier producer may have overwritten everything up to it.
void WaypointRingWriter::claim(Word items) noexcept {
  Word& claimed = control_[kClaimed];
  store(claimed, std::max(load(claimed, std::memory_order_relaxed), written_ + items),
        std::memory_order_relaxed);
}

/// The words of item written_ + index.
std::span<Word> WaypointRingWriter::item_words(Word index) const noexcept {
  const std::size_t stride = words_per_item(layout_);
  return items_.subspan(((written_ + index) & (layout_.capacity - 1)) * stride, stride);
}

/// Writes item written_ + index, each word with release (P1). Does not write values that are
/// absent.
void WaypointRingWriter::put_item(Word index, Word kind_and_flags,
                                  const Waypoint& values) noexcept {
  const auto words = item_words(index);
  const auto kind = static_cast<ItemKind>(kind_and_flags & kKindMask);
  has_begun_ = has_begun_ || (kind != ItemKind::replace && kind != ItemKind::finish);
  const Word flags = (values.velocity.empty() ? 0 : kHasVelocity) |
                     (values.acceleration.empty() ? 0 : kHasAcceleration);
  store(words[kItemKind], kind_and_flags | flags, std::memory_order_release);
  store(words[kItemTime], to_word(values.time), std::memory_order_release);
  const auto rest = words.subspan(kItemValues);
  store_values(rest.data(), values.position);
  store_values(rest.data() + layout_.dimensions, values.velocity);
  store_values(rest.data() + 2 * layout_.dimensions, values.acceleration);
}

void WaypointRingWriter::publish(Word items, Time last) noexcept {
  written_ += items;
  has_last_ = true;
  ends_with_stop_ = false;
  last_time_ = last;
  store(control_[kWritten], written_, std::memory_order_seq_cst);  // P2
}

AppendStatus WaypointRingWriter::counted(AppendStatus status) noexcept {
  if (status == AppendStatus::accepted) return status;
  Word& counter = control_[kProducerCounters + static_cast<std::size_t>(status)];
  store(counter, load(counter, std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  return status;
}

void WaypointRingWriter::retire() noexcept {
  store(control_[kRetired], 1, std::memory_order_release);
}

}  // namespace splinecast::ipc
