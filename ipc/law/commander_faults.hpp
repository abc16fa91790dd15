#pragma once

#include <set>
#include <string>
#include <vector>

#include "ipc/law/commanded_rate.hpp"
#include "ipc/law/commands.hpp"

namespace splinecast::ipc {

/// What a person must know of the commanders of a law: who is not heard, and who holds the law
/// without a request for it. One thread uses it. Allocates.
class CommanderFaults {
 public:
  /// Looks at the commanders of a law with this largest rate, and at the table of its last plan.
  void look(const Commanders& commanders, const CommandedRate& rate, double largest);

  /// Moves the faults that have come since the last call to the end of `out`, one sentence each.
  /// One that lasts is reported once; if it ends and comes again, once more.
  void take(std::vector<std::string>& out);

 private:
  std::set<std::string> present_;
  std::vector<std::string> new_;
};

}  // namespace splinecast::ipc
