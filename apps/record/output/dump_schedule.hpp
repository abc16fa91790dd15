#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// When dumps begin and end. Bounds their number and length for any number of events, so that each
/// event is in a dump that also has what was in memory before it:
///
/// - An event begins a dump, which ends `after` later. Later events prolong an open dump, but only
///   those within the first max(last, after) of it. After those, another dump follows it at once.
/// - A dump that an event begins less than `last` after the end of the dump before is open for
///   `last` at least. So in a time T events begin at most T / last + 2 dumps, and one more for each
///   trigger.
/// - A trigger always begins a dump. It ends an open one, and takes over the end of it.
///
/// Times are of the wall clock. One thread uses it.
class DumpSchedule {
 public:
  /// `last`: the time that the memory keeps.
  DumpSchedule(Time last, Time after) noexcept : last_(last), after_(after) {}

  [[nodiscard]] bool is_open() const noexcept { return is_open_; }
  /// Whether the open dump has to end.
  [[nodiscard]] bool is_due(Time now) const noexcept { return is_open_ && now >= end_; }

  /// Takes an event. Returns whether a dump begins with it.
  [[nodiscard]] bool take_event(std::string_view why, Time now);
  /// Begins a dump, also if another one is open.
  void take_trigger(Time now) noexcept;
  /// Ends the open dump. Returns the event for which another one begins now, if there is one.
  [[nodiscard]] std::optional<std::string> close(Time now);

  /// Events that began no dump, because one was open.
  [[nodiscard]] std::uint64_t further_events() const noexcept { return further_events_; }

 private:
  /// An event after which a dump has to follow the open one.
  struct Next {
    std::string why;
    Time until;
  };

  void begin(Time now, Time end) noexcept;

  Time last_;
  Time after_;
  bool is_open_ = false;
  Time began_{};
  Time end_{};
  std::optional<Time> ended_{};  ///< end of the last dump
  std::optional<Next> next_{};
  std::uint64_t further_events_ = 0;
};

}  // namespace splinecast::apps::record
