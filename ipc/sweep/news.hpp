#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ipc/layout/summary.hpp"
#include "splinecast/producer.hpp"
#include "splinecast/solver.hpp"

namespace splinecast::ipc {

/// What a process reports of a stream that it solves or waits for.
enum class SweepNews : std::uint8_t {
  waiting,         ///< there is no producer yet, or the stream has been removed
  solving,         ///< it is solved here now
  finished,        ///< the solver has taken its finish
  elsewhere,       ///< another process solves it; taken over when that dies
  no_descriptors,  ///< RLIMIT_NOFILE does not allow another one; retried when streams come or go
  refused,         ///< an item was refused, the first one for its reason
  beyond_limits,   ///< the curve exceeds a limit with a waypoint that was taken, the first one
  following,       ///< with Beyond::enter: it meets no waypoint, cannot follow, or follows again
  commander,       ///< of a time law: a commander is not heard, or holds it unasked; of another
                   ///< stream: a stopper holds it, or is not heard
  postponed,       ///< memory or descriptors are lacking; retried periodically
  given_up,        ///< it cannot be solved; retried when its files have been replaced
  gone,            ///< a stream that was found by a pattern no longer exists
};

/// Called with news. `solver` is not null if the stream is solved here; `why` is set for
/// `postponed`, `given_up`, `refused`, `beyond_limits` and `commander`. Exceptions are ignored.
using NotifyNews = std::function<void(SweepNews news, const std::string& stream,
                                      const Solver* solver, std::string_view why)>;

/// What has been reported of a solver since it attached. One thread uses it.
class ReportedNews {
 public:
  /// Memory that many of these share.
  struct Scratch {
    std::vector<ItemRefusal> refused;
    std::vector<std::string> faults;
  };

  /// Reports what a step has brought: first refusals, the first excess, faults of commanders and
  /// stoppers, a change of following, the finish. Allocates only if there are news.
  void report(Solver& solver, const NotifyNews& notify, Scratch& scratch) noexcept;

 private:
  bool was_finished_ = false;
  Following following_ = Following::meets;
};

}  // namespace splinecast::ipc
