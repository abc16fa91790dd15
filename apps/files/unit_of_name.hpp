#pragma once

#include <string>
#include <utility>

namespace splinecast::apps {

/// A column's name as `name [unit]` or `name (unit)`; without a unit the whole is the name.
[[nodiscard]] std::pair<std::string, std::string> name_and_unit(const std::string& column);

}  // namespace splinecast::apps
