#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "ipc/arguments/handles.hpp"
#include "ipc/arguments/refusals.hpp"
#include "ipc/arguments/waypoints.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/reader.hpp"
#include "splinecast/snapshot.hpp"
#include "splinecast/solver.hpp"

/// The objects of the roles' handles. Each begins with its mark.

struct splinecast_producer {
  splinecast::ipc::Mark<0x5350'4c50'524f'4401> mark;
  std::size_t dimensions;
  bool is_withdrawn = false;
  splinecast::Producer producer;
  splinecast::ipc::WaypointList waypoints{};
  splinecast::ipc::RefusalQueue refused{};
  splinecast::ReplacePreview preview{};

  splinecast_producer(std::string stream, splinecast::ProducerOptions options)
      : dimensions(options.dimensions), producer(std::move(stream), std::move(options)) {}
};

struct splinecast_solver {
  splinecast::ipc::Mark<0x5350'4c53'4f4c'5602> mark;
  splinecast::Solver solver;
  splinecast::MonotonicClock clock;
  splinecast::ipc::RefusalQueue refused{};

  splinecast_solver(std::string stream, const splinecast::SolverOptions& options)
      : solver(std::move(stream), options) {}
};

struct splinecast_reader {
  splinecast::ipc::Mark<0x5350'4c52'4541'4403> mark;
  splinecast::Reader reader;
  std::vector<std::string> names;
  std::vector<std::string> units;
  std::vector<std::string> kinds;       ///< their texts
  std::vector<splinecast::Time> times;  ///< of sample_many, as the next two
  std::vector<splinecast::SampleStatus> statuses;
  std::vector<double> values;
  splinecast::State sampled;  ///< of excess

  splinecast_reader(const std::string& stream, splinecast::Time timeout,
                    const splinecast::Trust& trust, std::size_t many);
};

struct splinecast_snapshot {
  splinecast::ipc::Mark<0x5350'4c53'4e41'5004> mark;
  splinecast::Snapshot snapshot;

  explicit splinecast_snapshot(std::size_t dimensions) : snapshot(dimensions) {}
};

namespace splinecast::ipc {

/// The producer of a handle, unless it has been withdrawn.
[[nodiscard]] inline splinecast_producer& require_producer(splinecast_producer* producer) {
  splinecast_producer& found = require_handle(producer, "producer");
  if (found.is_withdrawn) refuse("producer", "has been withdrawn");
  return found;
}

}  // namespace splinecast::ipc
