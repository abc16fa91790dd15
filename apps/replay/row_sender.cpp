#include "apps/replay/row_sender.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/replay/start.hpp"
#include "core/forms/entry.hpp"
#include "ipc/solve/stream_solver.hpp"

namespace splinecast::apps {

bool RowSender::send(const PlayedRow& row, Waypoint waypoint, bool follows_gap) {
  waypoint.time = saturated_sum(waypoint.time, late_.shifted);
  if (stop_requested() || (options_.rate && !pace(waypoint.time))) return false;
  entry_begin_.reset();
  if (follows_gap && last_time_ && !stop_at_gap(waypoint)) return false;
  const AppendStatus status = append_when_there_is_room(waypoint);
  if (status == AppendStatus::full) return false;
  if (status == AppendStatus::elsewhere) {
    throw InputError(elsewhere_message(producer_, waypoint));
  }
  if (status == AppendStatus::accepted) {
    if (has_gaps_) note_last(waypoint);
    rows_.note_sent(row, waypoint);
  } else {
    rows_.note_refusal(row, waypoint.time, status);
  }
  if (options_.rate || solver_.is_due()) {
    solver_.solve();
    rows_.look();
  }
  return true;
}

/// Waits until it is time to send: on a live stream `lead` before the waypoint's time, on a
/// recorded stream at the recorded time after the first waypoint.
bool RowSender::pace(Time waypoint_time) {
  if (options_.ring.clock == StreamClock::monotonic) {
    return solver_.wait_until(waypoint_time - lead_);
  }
  if (options_.ring.clock == StreamClock::law) return wait_for_stream_time(waypoint_time - lead_);
  if (rows_.sent() == 0) recorded_start_ = clock_.now() - waypoint_time;
  return solver_.wait_until(recorded_start_ + waypoint_time);
}

/// Waits until the law of the stream reaches a stream time; false if a stop is requested. Looks at
/// the law again after a short time, because its rate may change.
bool RowSender::wait_for_stream_time(Time instant) {
  constexpr Time kLooks = std::chrono::milliseconds(5);
  for (Time now = producer_.now(); now < instant; now = producer_.now()) {
    if (!solver_.wait_until(clock_.now() + std::min(instant - now, kLooks))) return false;
  }
  return !stop_requested();
}

/// Lets the motion stop at the last waypoint, and plans its beginning before the next one. A live
/// stream that has starved has stopped already. Returns false if a stop is requested.
bool RowSender::stop_at_gap(const Waypoint& next) {
  const bool moves = is_live(options_.ring.clock);
  if (!moves || producer_.earliest() <= *last_time_) {
    AppendStatus status = replace(*last_time_, {});
    while (status == AppendStatus::full) {
      if (stop_requested() || !await_room()) return false;
      status = replace(*last_time_, {});
    }
    if (status == AppendStatus::accepted) rows_.note_replacement(*last_time_);
  }
  const Time begin = entry_begin(next);
  // On a live stream the solver must get the replacement before its time settles. Otherwise an
  // entry leads from rest to the waypoint as soon as it arrives.
  constexpr Time kMargin = std::chrono::milliseconds(100);
  if (!moves || begin > producer_.earliest() + kMargin) entry_begin_ = begin;
  return true;
}

void RowSender::stop_at_once() {
  constexpr int kTries = 100;
  constexpr Time kPause = std::chrono::milliseconds(10);
  AppendStatus status = producer_.replace_from({});
  // Only a ring of fewer than 16 items has no places for stops.
  for (int i = 0; i < kTries && status == AppendStatus::full; ++i) {
    solver_.solve();
    (void)producer_.wait_for_room(kPause);
    status = producer_.replace_from({});
  }
  if (status == AppendStatus::accepted) {
    rows_.note_replacement(Time::min());
  } else {
    say(fmt::format(
        "'{}': the motion could not be stopped at once; it continues to the last waypoint",
        options_.stream));
  }
}

/// When the motion begins that leads to the first waypoint after a gap: so late that the way is
/// made with the velocities of the motion so far, in the second half of the gap.
Time RowSender::entry_begin(const Waypoint& next) const {
  constexpr double kShortest = 0.5;  // s
  const Time gap = next.time - *last_time_;
  double seconds = kShortest;
  for (std::size_t d = 0; d < last_.size(); ++d) {
    const double way = std::abs(next.position[d] - last_[d]);
    if (way == 0) continue;
    seconds = fastest_[d] > 0 ? std::max(seconds, core::seconds_from_rest(way, fastest_[d], 0, 0))
                              : HUGE_VAL;
  }
  const double most = to_seconds(gap) / 2;
  return next.time - from_seconds(std::min(seconds, most));
}

void RowSender::note_last(const Waypoint& waypoint) {
  fastest_.resize(waypoint.position.size());
  const bool is_joined = last_time_ && !entry_begin_;
  const double seconds = is_joined ? to_seconds(waypoint.time - *last_time_) : 0;
  for (std::size_t d = 0; d < last_.size() && seconds > 0; ++d) {
    fastest_[d] = std::max(fastest_[d], std::abs(waypoint.position[d] - last_[d]) / seconds);
  }
  last_.assign(waypoint.position.begin(), waypoint.position.end());
  last_time_ = waypoint.time;
}

/// Appends a waypoint, with `--late shift` moved if it is late. Returns `full` if a stop is
/// requested while it waits for room.
AppendStatus RowSender::append_when_there_is_room(Waypoint& waypoint) {
  const Time intended = waypoint.time;
  Time lateness = shift_if_late(waypoint);
  AppendStatus status = append(waypoint);
  while (status == AppendStatus::full) {
    if (stop_requested() || !await_room()) return status;
    lateness = std::max(lateness, shift_if_late(waypoint));
    status = append(waypoint);
  }
  note_lateness(lateness, waypoint.time - intended);
  return status;
}

/// Returns the lateness of a waypoint that is sent now: the time from the waypoint to the settled
/// time, 0 if the waypoint is later. With `--late shift`, moves a late waypoint to `lead` after
/// now.
Time RowSender::shift_if_late(Waypoint& waypoint) {
  if (!is_live(options_.ring.clock)) return {};
  const Time now = producer_.now();
  const Time lateness = std::max(producer_.earliest() - waypoint.time, Time::zero());
  if (lateness > Time::zero() && options_.late == LatePolicy::shift) {
    waypoint.time = std::max(waypoint.time, now + lead_);
  }
  return lateness;
}

/// Counts a late waypoint. If it was moved, moves all later ones by the same time.
void RowSender::note_lateness(Time lateness, Time moved_by) {
  if (lateness == Time::zero()) return;
  late_.count(&LateRows::past, lateness);
  if (moved_by > Time::zero()) late_.shift(moved_by);
}

/// Appends a waypoint; the first one after a gap as a replacement from where the motion begins
/// again, unless it is too late for that.
AppendStatus RowSender::append(const Waypoint& waypoint) {
  if (is_late()) return AppendStatus::full;
  if (entry_begin_) {
    const AppendStatus status = replace(*entry_begin_, {&waypoint, 1});
    if (status == AppendStatus::accepted) rows_.note_replacement(*entry_begin_);
    if (status != AppendStatus::too_late) return status;
  }
  return producer_.append(waypoint);
}

AppendStatus RowSender::replace(Time t, std::span<const Waypoint> waypoints) {
  return is_late() ? AppendStatus::full : producer_.replace_from(t, waypoints);
}

/// Whether kRefusalsKept earlier items are undecided: the board could overwrite a refusal before it
/// is read. A ring of more than kRefusalsKept items is not throttled.
bool RowSender::is_late() const {
  rows_.look();
  const bool is_late =
      rows_.undecided() >= ipc::kRefusalsKept && options_.ring.capacity <= ipc::kRefusalsKept;
  if (is_late) rows_.require_readable();
  return is_late;
}

bool RowSender::await(const std::function<bool()>& wait) {
  Time end = deadline(clock_, options_.wait);
  for (;;) {
    solver_.solve();
    rows_.look_if_begun();
    if (wait()) return true;
    if (stop_requested()) return false;
    if (producer_.solver_alive()) {
      end = deadline(clock_, options_.wait);
    } else if (clock_.now() >= end) {
      throw TimeOut(
          fmt::format("the solver of stream '{}' has ended and no other attached within {} s",
                      options_.stream, to_seconds(options_.wait)));
    }
  }
}

bool RowSender::await_room() {
  return await([this] { return producer_.wait_for_room(solver_.slice()); });
}

bool RowSender::await_consumption() {
  return await([this] { return producer_.wait_until_consumed(solver_.slice()); });
}

}  // namespace splinecast::apps
