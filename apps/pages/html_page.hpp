#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "apps/output/stream.hpp"

namespace splinecast::apps {

/// Writes a page as one HTML file that needs nothing else: a template of apps/page/ with its data
/// where it says `@data@`, as JSON in which nothing can end the script element it stands in.
/// Throws as Output does.
void write_page(std::string_view page, const nlohmann::ordered_json& data, Output& output);

}  // namespace splinecast::apps
