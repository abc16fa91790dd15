#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Plays a controller: samples a live stream at 1 kHz until it has ended or a stop is requested,
/// and checks what it reads as no controller has the time to. Returns what it saw: counts by
/// status, largest steps, ages and times.
nlohmann::json run_demo_reader(const std::string& stream);

}  // namespace splinecast::apps
