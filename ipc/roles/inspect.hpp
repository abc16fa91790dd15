#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "ipc/board/refusal_record.hpp"
#include "ipc/layout/board_control.hpp"
#include "ipc/layout/header.hpp"
#include "ipc/layout/summary.hpp"
#include "ipc/requests/stopper_table.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/options.hpp"
#include "splinecast/status.hpp"

namespace splinecast::ipc {

/// The state of a stream on this host, as an observer sees it.
struct StreamInfo {
  std::string stream;
  bool producer_alive = false;
  bool solver_alive = false;
  std::optional<RegionHeader> waypoints;  ///< header of the producer's region
  std::optional<RegionHeader> spline;     ///< header of the solver's region
  Word appended = 0;
  std::array<Word, kAppendStatuses> refused_by_producer{};  ///< by AppendStatus
  Summary summary;                                          ///< revision 0: nothing solved yet
  std::array<Word, kStepBuckets> step_times{};  ///< steps of the solver that took 2ⁱ to 2ⁱ⁺¹ ns
  std::optional<MotionLimits> shown;    ///< of a live stream: limits that its motion shows, from
                                        ///< the waypoints on the board; see ShownMotion
  std::vector<RefusalRecord> refusals;  ///< the last items refused, oldest first: kRefusalsKept,
                                        ///< fewer if the solver has overwritten some meanwhile
  std::vector<LimitExcess> excesses;    ///< the last excesses, oldest first: at most kExcessesKept
  std::optional<LimitExcess> worst_excess;  ///< the largest one of a waypoint that was not refused
  std::vector<StopperEntry> stoppers;       ///< by the board: what is in force
};

/// Inspects a stream. The settled time of the summary is that of Reader::settled_until(), which
/// reads the law of a stream that follows one. Throws NoSuchStream if it has no region, BadRegion
/// if a region cannot be used.
[[nodiscard]] StreamInfo inspect(const std::string& stream, const Trust& trust = {});

}  // namespace splinecast::ipc
