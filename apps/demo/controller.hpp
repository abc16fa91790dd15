#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Runs a controller: samples a live stream at 1 kHz until it has ended or a stop is requested, and
/// checks what it reads. Returns counts by status, largest steps, ages of the data and times per
/// sample.
nlohmann::json run_demo_reader(const std::string& stream);

}  // namespace splinecast::apps
