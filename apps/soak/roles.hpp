#pragma once

#include <chrono>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// What a soak is told.
struct SoakOptions {
  std::size_t streams = 100;
  Time seconds = std::chrono::seconds(60);
  double rate = 100;        ///< waypoints a second and stream
  std::size_t readers = 2;  ///< processes, each of which reads all streams
  bool json = false;
};

/// A producer process: makes these streams, or goes on with them, and sends a joint motion that
/// begins at `start` until a stop is requested; then finishes them. Returns what it has sent.
nlohmann::json run_soak_producers(const std::vector<std::string>& streams, double rate, Time start);

/// A reader process: samples each of these streams at 50 Hz and checks what it reads until a stop
/// is requested. Returns what it saw.
nlohmann::json run_soak_reader(const std::vector<std::string>& streams);

/// Many streams at once in real processes: one that solves, some that produce, of which one is
/// killed every two seconds and comes back, and some that read. Returns what was done and found;
/// `sound` is whether nothing grew, was lost, stepped or changed; null, and `judged` false, if a
/// stop was requested before the end. Throws Interrupted if it came before there is anything to
/// tell. Prints a table unless
/// options.json is set.
nlohmann::json run_soak(const SoakOptions& options);

}  // namespace splinecast::apps
