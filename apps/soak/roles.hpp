#pragma once

#include <chrono>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "splinecast/time.hpp"

namespace splinecast::apps {

/// Options of `soak`.
struct SoakOptions {
  std::size_t streams = 100;
  Time seconds = std::chrono::seconds(60);
  double rate = 100;        ///< waypoints per second and stream
  std::size_t readers = 2;  ///< processes, each of which reads all streams
  bool json = false;
};

/// A producer process: creates these streams, or resumes them, and sends a joint motion that begins
/// at `start` until a stop is requested; then finishes them. Returns the counts `sent` and
/// `refused`.
nlohmann::json run_soak_producers(const std::vector<std::string>& streams, double rate, Time start);

/// A reader process: samples each of these streams at 50 Hz and checks what it reads until a stop
/// is requested. Returns counts of samples and findings.
nlohmann::json run_soak_reader(const std::vector<std::string>& streams);

/// Runs many streams in real processes: one solver, some producers, of which one is killed and
/// restarted every two seconds, and some readers. Returns the faults and findings; `sound` is
/// whether nothing grew, was lost, stepped or changed; it is null, and `judged` false, if a stop
/// was requested before the end. Throws Interrupted if a stop was requested before there is a
/// result. Prints a table unless options.json is set.
nlohmann::json run_soak(const SoakOptions& options);

}  // namespace splinecast::apps
