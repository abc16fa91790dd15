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

/// What the processes of `latency` note, and the latencies that follow from it. All times are
/// CLOCK_MONOTONIC.
namespace splinecast::apps {

/// In place of the number of an item: of a waypoint that the producer's append refused.
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
  ipc::Word consumed = 0;  ///< items that it and those before it contain
  Time solved{};           ///< directly before it was written to the board
  Time published{};        ///< after the commit, and after waking who waits
};

/// A revision that a reader got a sample of, for the first time.
struct SeenStamp {
  ipc::Word revision = 0;
  Time seen{};  ///< after the sample
};

/// The latencies of one stage of the way from the producer's append to a reader's sample.
struct Latencies {
  std::string stage;
  Histogram intended;  ///< from the intended instant on: what users of the waypoint wait
  Histogram raw;       ///< from the begin of the append on: what the pipeline takes, which leaves
                       ///< out what held the producer up
  TimeGrid over_time;  ///< `intended`, over the measured time
  std::uint64_t missed = 0;   ///< of `intended`, beyond the deadline; what never came included
  std::uint64_t missing = 0;  ///< waypoints that never got to this stage
};

/// What is measured: waypoints due from `from` to before `until`.
struct Measured {
  Time from{};
  Time until{};
  Time deadline{};
};

/// Sorts out stamps: the latencies at the stages `append`, `solved` and `published`, and of each
/// reader `seen`. Items in `refused` (ascending), which the solver took but did not interpolate,
/// count as missing from `solved` on. Each of the spans is in the order of its numbers.
[[nodiscard]] std::vector<Latencies> latencies_of(
    std::span<const AppendStamp> appends, std::span<const RevisionStamp> revisions,
    const std::vector<std::span<const SeenStamp>>& readers, std::span<const ipc::Word> refused,
    const Measured& measured);

/// A stage without latencies.
[[nodiscard]] Latencies make_stage(std::string name, const Measured& measured);

/// Adds one waypoint's latency at a stage.
void add(Latencies& stage, const AppendStamp& append, Time reached, const Measured& measured);

/// Adds one that never got there.
void add_missing(Latencies& stage);

}  // namespace splinecast::apps
