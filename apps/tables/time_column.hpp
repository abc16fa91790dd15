#pragma once

#include <optional>
#include <string_view>

#include "apps/files/numbers.hpp"

namespace splinecast::apps {

/// The unit of a time column by its name, or nothing if the name is not one of a time column.
[[nodiscard]] std::optional<TimeUnit> unit_of_time_column(std::string_view name);

}  // namespace splinecast::apps
