#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/record/watch/batch.hpp"
#include "apps/record/watch/clocks.hpp"
#include "apps/record/watch/stream_watch.hpp"
#include "ipc/memory/poll_schedule.hpp"
#include "ipc/memory/region_watch.hpp"
#include "splinecast/options.hpp"

namespace splinecast::apps::record {

/// Watches many streams in one thread: those that are named, and those that match a pattern as they
/// come and go. Polls the streams by a PollSchedule.
class Watcher {
 public:
  /// Called when a stream is recorded from now on, and with the reason when one cannot be recorded,
  /// once until it has been replaced.
  using Notify = std::function<void(std::string_view stream, std::string_view why, bool is_lost)>;

  /// Each of `wanted` is a name or a pattern, see ipc::is_pattern(). Throws BadRequest for an
  /// invalid name.
  Watcher(const std::vector<std::string>& wanted, const Trust& trust, Notify notify);

  /// Looks at every stream that is due. Writes what is new into the batch, and sets its time.
  /// `may_attach`: whether it looks for further streams, too.
  void sweep(Batch& batch, bool may_attach);

  /// Time to wait before the next sweep: 0 while some stream has much to read.
  [[nodiscard]] Time next_pause() const noexcept;

  /// Reads what is left, and the last summaries.
  void finish(Batch& batch);

  /// The records of a batch were dropped.
  void note_dropped(const Batch& batch) noexcept;

  /// Number of streams that are attached.
  [[nodiscard]] std::size_t attached() const noexcept;
  /// Whether every named stream is finished and has been read, and there are no patterns.
  [[nodiscard]] bool are_all_finished() const noexcept;
  /// Whether a stream has been attached so far.
  [[nodiscard]] bool has_seen_any() const noexcept { return has_seen_any_; }
  [[nodiscard]] const WallClock& clock() const noexcept { return clock_; }

 private:
  struct Member {
    std::uint32_t number;
    StreamWatch watch;
    bool is_named = false;
    bool is_refused = false;  ///< it cannot be recorded; tried again when files come or go
    Time active{};            ///< when it last had something to read
    Time next_owners = Time::min();
  };

  /// Of a member.
  [[nodiscard]] static std::uint32_t number_of(const std::unique_ptr<Member>& member) noexcept {
    return member->number;
  }
  void look_around(Batch& batch);
  void find_streams(Time now);
  void forget_gone(Time now);
  void attach(Batch& batch, Member& member, bool was_there);
  Member& add(const std::string& stream, bool is_named);

  std::vector<std::string> patterns_;
  Trust trust_;
  Notify notify_;
  WallClock clock_;
  ipc::RegionWatch regions_;
  ipc::Word regions_seen_ = 0;  ///< version of the regions when the streams were attached last
  std::vector<std::unique_ptr<Member>> members_;  ///< by number
  std::uint32_t last_number_ = 0;
  std::map<std::string, Member*, std::less<>> by_name_;
  Time next_look_ = Time::min();
  Time next_forget_{};
  ipc::PollSchedule schedule_{std::chrono::milliseconds(2)};
  bool has_looked_around_ = false;
  bool is_late_ = false;
  bool is_fast_ = false;
  bool has_detached_ = false;
  bool has_seen_any_ = false;
};

}  // namespace splinecast::apps::record
