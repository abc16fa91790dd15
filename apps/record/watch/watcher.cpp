#include "apps/record/watch/watcher.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "ipc/memory/names.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::apps::record {
namespace {

/// Interval of looks for files that come or go, and for processes that take over.
constexpr Time kLookAround = std::chrono::milliseconds(5);
constexpr Time kLookAtOwners = std::chrono::milliseconds(100);
/// A name that is gone is forgotten after this time.
constexpr Time kForget = std::chrono::seconds(2);
/// The pause after a sweep that has read a large part of a ring.
constexpr Time kFastPause = std::chrono::milliseconds(1);
/// A sweep that reads more records of one stream than this is followed by another one at once.
constexpr std::size_t kMany = 128;

}  // namespace

Watcher::Watcher(const std::vector<std::string>& wanted, const Trust& trust, Notify notify)
    : trust_(trust), notify_(std::move(notify)) {
  for (const std::string& text : wanted) {
    if (ipc::is_pattern(text)) {
      patterns_.push_back(text);
    } else {
      ipc::require_stream_name(text);
      add(text, true);
    }
  }
}

Watcher::Member& Watcher::add(const std::string& stream, bool is_named) {
  members_.push_back(std::make_unique<Member>(
      Member{.number = ++last_number_,
             .watch = StreamWatch(last_number_, stream, trust_, clock_.offset()),
             .is_named = is_named}));
  by_name_.emplace(stream, members_.back().get());
  return *members_.back();
}

void Watcher::sweep(Batch& batch, bool may_attach) {
  batch.now = clock_.now();
  if (batch.now >= next_look_ && may_attach) {
    next_look_ = batch.now + kLookAround;
    look_around(batch);
  }
  if (batch.now >= next_forget_) {
    next_forget_ = batch.now + kForget;
    forget_gone(batch.now);
  }
  schedule_.begin(batch.now);
  is_late_ = false;
  is_fast_ = false;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Member& member = *members_[i];
    if (!schedule_.reads(i, member.active)) continue;
    if (batch.now >= member.next_owners) {
      member.next_owners = batch.now + kLookAtOwners;
      member.watch.look_at_owners(batch);
    }
    if (!member.watch.calls()) continue;
    const std::size_t before = batch.records.size();
    member.watch.look(batch);
    // The next stream of this name may exist already.
    has_detached_ = has_detached_ || !member.watch.is_complete();
    member.active = batch.now;
    is_late_ = is_late_ || batch.records.size() - before > kMany;
    is_fast_ = is_fast_ || member.watch.is_filled_fast();
    schedule_.note_work();
  }
}

Time Watcher::next_pause() const noexcept {
  if (is_late_) return Time::zero();
  return is_fast_ ? kFastPause : schedule_.next_pause();
}

void Watcher::look_around(Batch& batch) {
  regions_.poll();
  // A ring or a board can appear only with a new file.
  if (regions_.version() == regions_seen_ && !has_detached_) return;
  regions_seen_ = regions_.version();
  has_detached_ = false;
  find_streams(batch.now);
  const bool were_there = !std::exchange(has_looked_around_, true);
  for (const auto& member : members_) {
    attach(batch, *member, were_there);
  }
}

/// Forgets streams that match a pattern and are gone, so that the work does not grow with the names
/// that there have ever been.
void Watcher::forget_gone(Time now) {
  std::erase_if(members_, [&](const auto& member) {
    const bool is_gone = !member->is_named && !member->is_refused && !member->watch.is_attached() &&
                         member->active <= now - kForget;
    if (is_gone) by_name_.erase(member->watch.stream());
    return is_gone;
  });
}

void Watcher::find_streams(Time now) {
  if (patterns_.empty()) return;
  for (const std::string& stream : regions_.streams()) {
    if (by_name_.contains(stream)) continue;
    const bool is_wanted = std::ranges::any_of(
        patterns_, [&](const std::string& pattern) { return ipc::matches(pattern, stream); });
    if (is_wanted) add(stream, false).active = now;
  }
}

void Watcher::attach(Batch& batch, Member& member, bool was_there) {
  try {
    const bool was_attached = member.watch.is_attached();
    if (member.watch.attach(batch, was_there)) member.active = batch.now;
    if (!was_attached && member.watch.is_attached()) {
      notify_(member.watch.stream(), "recording", false);
    }
    member.is_refused = false;
  } catch (const StreamError& error) {
    if (!member.is_refused) notify_(member.watch.stream(), error.what(), true);
    member.is_refused = true;
  }
  has_seen_any_ = has_seen_any_ || member.watch.is_attached();
}

void Watcher::finish(Batch& batch) {
  batch.now = clock_.now();
  for (const auto& member : members_) {
    member->watch.look(batch);
    member->watch.put_summary(batch);
  }
}

void Watcher::note_dropped(const Batch& batch) noexcept {
  for (const Record& record : batch.records) {
    const auto found = std::ranges::lower_bound(members_, record.stream, {}, &number_of);
    if (found != members_.end() && number_of(*found) == record.stream)
      (*found)->watch.begin_again();
  }
}

std::size_t Watcher::attached() const noexcept {
  return static_cast<std::size_t>(std::ranges::count_if(
      members_, [](const auto& member) { return member->watch.is_attached(); }));
}

bool Watcher::are_all_finished() const noexcept {
  return patterns_.empty() && std::ranges::all_of(members_, [](const auto& member) {
           return member->watch.is_finished();
         });
}

}  // namespace splinecast::apps::record
