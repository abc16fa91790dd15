#pragma once

#include <string_view>

namespace splinecast::apps {

/// The pages of apps/page/ with the scripts and styles they use: of `fit --report` and of `latency
/// --report`. The JSON goes where they say `@data@`.
[[nodiscard]] std::string_view report_template() noexcept;
[[nodiscard]] std::string_view latency_template() noexcept;

}  // namespace splinecast::apps
