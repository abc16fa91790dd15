#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "ipc/roles/inspect.hpp"

namespace splinecast::apps {

/// A stream as `info --json` and `ls --json` give it; keys in the order they are written.
[[nodiscard]] nlohmann::ordered_json to_json(const ipc::StreamInfo& info);

/// JSON as text; bytes of a header that are not UTF-8 are replaced.
[[nodiscard]] std::string pretty(const nlohmann::ordered_json& json);

/// One word for where a stream is in its life: `waiting`, `running`, `finished`, `retired` …
[[nodiscard]] std::string state_of(const ipc::StreamInfo& info);

/// What a summary says behind the number of waypoints that are interpolated: `, 12 passed over`, or
/// nothing for 0.
[[nodiscard]] std::string passed_over_in_words(ipc::Word count);

}  // namespace splinecast::apps
