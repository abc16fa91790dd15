#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "splinecast/ipc/stream_files.hpp"

namespace splinecast::apps {

/// A stream as `info --json` and `ls --json` give it; keys in the order they are written.
[[nodiscard]] nlohmann::ordered_json to_json(const ipc::StreamInfo& info);

/// One word for where a stream is in its life: `waiting`, `running`, `finished`, `retired` …
[[nodiscard]] std::string state_of(const ipc::StreamInfo& info);

}  // namespace splinecast::apps
