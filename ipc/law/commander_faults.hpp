#pragma once

#include <set>
#include <string>

#include "ipc/law/commanded_rate.hpp"
#include "ipc/law/commands.hpp"

namespace splinecast::ipc {

/// What a person must know of the commanders of a law with this largest rate, by the table of its
/// last plan: who is not heard, and who holds the law without a request for it. One sentence each.
[[nodiscard]] std::set<std::string> faults_of(const Commanders& commanders,
                                              const CommandedRate& rate, double largest);

}  // namespace splinecast::ipc
