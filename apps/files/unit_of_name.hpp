#pragma once

#include <string>
#include <utility>

namespace splinecast::apps {

/// Splits a column's title, `name [unit]` or `name (unit)`, into name and unit. Without a unit the
/// whole title is the name.
[[nodiscard]] std::pair<std::string, std::string> name_and_unit(const std::string& column);

}  // namespace splinecast::apps
