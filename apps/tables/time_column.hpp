#pragma once

#include <optional>
#include <string_view>

#include "apps/files/numbers.hpp"

namespace splinecast::apps {

/// The unit of a time column from its name; nothing for the name of another column.
[[nodiscard]] std::optional<TimeUnit> unit_of_time_column(std::string_view name);

}  // namespace splinecast::apps
