#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "apps/record/format/record.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// The kinds of events. JsonMessages::event_schema() has the members of all.
enum class EventKind : std::uint8_t {
  attached,
  underrun,
  deadline,
  late,
  refusal,
  takeover,
  limit,
  finished,
  retired,
  lost,
  following,
  stopped,        ///< a stopper holds the stream
  released,       ///< it does not any more
  returned,       ///< the curve meets a waypoint again
  limit_settled,  ///< what became of an excess
};
inline constexpr std::uint8_t kEventKinds = 15;

/// An event that a batch has.
struct EventNote {
  std::uint32_t stream = 0;
  EventKind kind{};
  bool is_old = false;  ///< it occurred before the recorder came: begins no dump

  friend bool operator==(const EventNote&, const EventNote&) = default;
};

/// Whether a record is the event with which a stream ends.
[[nodiscard]] inline bool is_end_of_stream(const Record& record) noexcept {
  return record.kind == RecordKind::event &&
         record.number == static_cast<ipc::Word>(EventKind::retired);
}

/// Records on their way from the observer to the file, in the order in which they were read.
struct Batch {
  std::vector<Record> records{};
  std::vector<EventNote> events{};  ///< those of `records`
  std::size_t bytes = 0;            ///< of the records, about
  Time now{};                       ///< wall clock

  void add(Record record) {
    constexpr std::size_t kOverhead = sizeof(Record) + 16;
    bytes += record.bytes.size() + kOverhead;
    record.seen = now;
    records.push_back(std::move(record));
  }
};

}  // namespace splinecast::apps::record
