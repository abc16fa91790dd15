#pragma once

#include <string_view>

namespace splinecast::apps {

/// The page of apps/page/ with the scripts and styles it uses; the report's JSON goes where it says
/// `@data@`.
[[nodiscard]] std::string_view report_template() noexcept;

}  // namespace splinecast::apps
