#pragma once

#include <set>
#include <string>
#include <vector>

namespace splinecast::ipc {

/// What a person must know of the commanders of a law or the stoppers of a stream. One thread uses
/// it. Allocates.
class RequestFaults {
 public:
  /// Sets the faults that are present now, one sentence each.
  void set(std::set<std::string> present);

  /// Moves the faults that have come since the last call to the end of `out`. One that lasts is
  /// reported once; if it ends and comes again, once more.
  void take(std::vector<std::string>& out);

 private:
  std::set<std::string> present_;
  std::vector<std::string> new_;
};

}  // namespace splinecast::ipc
