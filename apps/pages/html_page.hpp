#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "apps/output/stream.hpp"

namespace splinecast::apps {

/// Writes a page as one self-contained HTML file: a template of apps/pages/ in which the data
/// replaces `@data@`, as JSON that cannot end its script element. Throws as Output does.
void write_page(std::string_view page, const nlohmann::ordered_json& data, Output& output);

}  // namespace splinecast::apps
