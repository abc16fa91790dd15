#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "apps/timing/histogram.hpp"
#include "apps/timing/time_grid.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

/// The time stamps of the processes of `latency`, and the latencies computed from them. All times
/// are CLOCK_MONOTONIC.
namespace splinecast::apps {

/// In place of an item's number, for a waypoint that the producer's append refused.
inline constexpr ipc::Word kRefusedItem = std::numeric_limits<ipc::Word>::max();

/// A waypoint that the producer appended, or tried to.
struct AppendStamp {
  ipc::Word item = 0;  ///< its number in the ring, or kRefusedItem
  Time intended{};     ///< when it was due
  Time begun{};        ///< before the first try to append it
  Time appended{};     ///< after the append
};

/// A revision that the solver committed.
struct RevisionStamp {
  ipc::Word revision = 0;
  ipc::Word consumed = 0;  ///< items that it and earlier revisions contain
  Time solved{};           ///< directly before it was written to the board
  Time published{};        ///< after the commit and the wake-up of waiting readers
};

/// The first sample that a reader got of a revision.
struct SeenStamp {
  ipc::Word revision = 0;
  Time seen{};  ///< after the sample
};

/// The latencies of one stage between the producer's append and a reader's sample.
struct Latencies {
  std::string stage;
  Histogram intended;         ///< from the intended instant, with delays of the producer
  Histogram raw;              ///< from the start of the append, without delays of the producer
  TimeGrid over_time;         ///< `intended`, over the measured time
  std::uint64_t missed = 0;   ///< waypoints later than the deadline, with the `missing` ones
  std::uint64_t missing = 0;  ///< waypoints that never reached this stage
};

/// The measured waypoints: those due from `from` to before `until`.
struct Measured {
  Time from{};
  Time until{};
  Time deadline{};
};

/// Computes latencies from stamps: at the stages `append`, `solved` and `published`, and `seen` for
/// each reader. Items in `refused` (ascending), which the solver consumed but did not interpolate,
/// count as missing from `solved` on. Each span is sorted by item or revision number.
[[nodiscard]] std::vector<Latencies> latencies_of(
    std::span<const AppendStamp> appends, std::span<const RevisionStamp> revisions,
    const std::vector<std::span<const SeenStamp>>& readers, std::span<const ipc::Word> refused,
    const Measured& measured);

/// A stage without latencies.
[[nodiscard]] Latencies make_stage(std::string name, const Measured& measured);

/// Adds one waypoint's latency at a stage.
void add(Latencies& stage, const AppendStamp& append, Time reached, const Measured& measured);

/// Adds one waypoint that never reached the stage.
void add_missing(Latencies& stage);

}  // namespace splinecast::apps
