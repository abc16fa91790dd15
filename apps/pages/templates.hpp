#pragma once

#include <string_view>

namespace splinecast::apps {

/// The pages of `fit --report` and of `latency --report`, from apps/pages/, with their scripts and
/// styles. `@data@` marks the place of the JSON data.
[[nodiscard]] std::string_view report_template() noexcept;
[[nodiscard]] std::string_view latency_template() noexcept;

}  // namespace splinecast::apps
