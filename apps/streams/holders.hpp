#pragma once

#include <map>
#include <string>
#include <vector>

#include "splinecast/options.hpp"

namespace splinecast::apps {

/// The names of the stoppers that request to hold a stream, for each stream that has one, whether
/// or not it exists. Reads their regions. Throws OutOfResources if the folder of shared memory
/// cannot be read.
using Holders = std::map<std::string, std::vector<std::string>>;
[[nodiscard]] Holders holders_by_stream(const Trust& trust);

/// `'anna', 'panel'`
[[nodiscard]] std::string quoted(const std::vector<std::string>& names);

}  // namespace splinecast::apps
