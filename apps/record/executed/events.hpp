#pragma once

#include <string>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// An event of a stream in a recording.
struct RecordedEvent {
  Time time{};       ///< of the stream
  std::string text;  ///< its name, and what belongs to it
};

/// The most events that read_events() returns.
inline constexpr std::size_t kMostEvents = 2000;

/// The events of a stream, `/NAME/events`, in the order of the file, at most kMostEvents. Leaves
/// out messages that are not JSON objects with `time_ns` and `event`. Throws InputError for a
/// damaged file.
[[nodiscard]] std::vector<RecordedEvent> read_events(const std::string& path,
                                                     const std::string& stream);

}  // namespace splinecast::apps::record
