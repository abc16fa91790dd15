#pragma once

#include <initializer_list>
#include <string>

#include "apps/machine/facts.hpp"
#include "apps/machine/finding.hpp"

namespace splinecast::apps {

/// Those of these files that cannot be read, with reasons; empty if all can.
[[nodiscard]] std::string unread(const MachineFacts& facts,
                                 std::initializer_list<const char*> files);

/// The finding of a check whose facts are unknown.
[[nodiscard]] Finding unknown(const std::string& check, const std::string& why);

}  // namespace splinecast::apps
