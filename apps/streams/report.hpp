#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "ipc/roles/inspect.hpp"

namespace splinecast::apps {

/// A stream as in `info --json` and `ls --json`; keys in their order of output.
[[nodiscard]] nlohmann::ordered_json to_json(const ipc::StreamInfo& info);

/// JSON as text; bytes of a header that are not UTF-8 are replaced.
[[nodiscard]] std::string pretty(const nlohmann::ordered_json& json);

/// The state of a stream as text: `waiting for a producer`, `running`, `finished` …
[[nodiscard]] std::string state_of(const ipc::StreamInfo& info);

/// How a finished curve ends: the kind, the item that finished it, and how late it rests at the
/// last waypoint; null if it is not finished.
[[nodiscard]] nlohmann::ordered_json end_json(const ipc::Summary& summary);

/// The name of a kind of end: `as requested`, `slowed` …; empty for `none`.
[[nodiscard]] std::string_view to_string(ipc::EndKind kind);

/// The text about an end that differs from the requested one: `rests at the last waypoint 0.074 s
/// late`; empty for others.
[[nodiscard]] std::string end_in_words(ipc::EndKind kind, Time lateness);

/// The same as an addition to a line: after `; `, if it is not empty.
[[nodiscard]] std::string end_in_words(const ipc::Summary& summary);

/// Whether the curve follows its waypoints, as a sentence without a full stop.
[[nodiscard]] std::string following_in_words(const ipc::Summary& summary);

/// The text after the number of interpolated waypoints: `, 12 passed over`; empty for 0.
[[nodiscard]] std::string passed_over_in_words(ipc::Word count);

}  // namespace splinecast::apps
