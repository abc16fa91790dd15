#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/online/sliding_window.hpp"
#include "ipc/board/segment.hpp"
#include "splinecast/dimension_kind.hpp"
#include "splinecast/limits.hpp"
#include "splinecast/status.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// What became of an excess of a limit when the curve had settled at its time.
struct SettledExcess {
  enum class Outcome : std::uint8_t {
    executed,  ///< the settled curve exceeds the limit there
    replaced,  ///< it keeps it: the curve was changed in time
    unknown,   ///< the segment was not read
  };
  LimitExcess excess{};  ///< if executed: the largest one of the settled segment
  Outcome outcome{};
};

/// Excesses that the solver has reported and whose time has not settled yet. An excess is found
/// when a waypoint is appended; later waypoints, a stop and a replacement still change the curve.
/// One thread uses it.
class SettledExcesses {
 public:
  /// For a stream with these options.
  SettledExcesses(const core::WindowOptions& options, DimensionKinds kinds);

  /// Adds an excess of an accepted waypoint. Returns the one that is dropped if there are too many.
  [[nodiscard]] std::optional<SettledExcess> add(const LimitExcess& excess);

  /// Takes the next settled segment. Returns the excesses whose outcome is known with it.
  [[nodiscard]] std::vector<SettledExcess> take(const ipc::SegmentCopy& segment);

  /// The curve has ended. Returns the other excesses.
  [[nodiscard]] std::vector<SettledExcess> finish();

 private:
  [[nodiscard]] SettledExcess look_up(const LimitExcess& excess,
                                      const ipc::SegmentCopy& segment) const;
  [[nodiscard]] MotionLimits only(LimitKind kind, std::size_t dimension) const;

  /// A curve may be replaced any number of times before it settles.
  static constexpr std::size_t kMostOpen = 4096;

  MotionLimits limits_;
  DimensionKinds kinds_;
  std::multimap<Time, LimitExcess> open_;  ///< by time
};

/// Members of the JSON object of its event.
[[nodiscard]] std::string members_of(const SettledExcess& settled,
                                     const std::vector<std::string>& names);

}  // namespace splinecast::apps::record
