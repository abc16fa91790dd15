#pragma once

#include <optional>

#include "ipc/board/segment.hpp"
#include "ipc/memory/word.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// The curve meets a waypoint again.
struct Return {
  Time time{};                 ///< of the waypoint
  std::optional<Time> away{};  ///< since it left its waypoints; empty if that was not read
  ipc::Word run_item = 0;      ///< the waypoint's item is this one or a later one
};

/// Finds where a curve that has left its waypoints meets one again: it leaves them with a stop, or
/// with an entry that a replacement begins. One thread uses it.
class Returns {
 public:
  /// Takes the next settled segment. `before`: the segment before it; null if that is unknown, and
  /// for segment 1.
  [[nodiscard]] std::optional<Return> take(const ipc::SegmentCopy* before,
                                           const ipc::SegmentCopy& segment) noexcept;

 private:
  bool has_met_ = false;  ///< a waypoint, so that the curve can leave
  bool is_away_ = false;
  std::optional<Time> since_{};
  ipc::Word run_item_ = 0;  ///< of the last entry
};

}  // namespace splinecast::apps::record
