#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace splinecast::apps {

/// The template with each mark, which it contains once, replaced by its text.
[[nodiscard]] std::string filled(std::string_view script,
                                 const std::vector<std::pair<std::string, std::string>>& texts);

}  // namespace splinecast::apps
