#pragma once

#include <initializer_list>
#include <string>

#include "apps/machine/facts.hpp"
#include "apps/machine/finding.hpp"

namespace splinecast::apps {

/// The paths of those of these files that cannot be read, and why; empty if all can.
[[nodiscard]] std::string unread(const MachineFacts& facts,
                                 std::initializer_list<const char*> files);

/// What a check finds where nothing can be known.
[[nodiscard]] Finding unknown(const std::string& check, const std::string& why);

}  // namespace splinecast::apps
