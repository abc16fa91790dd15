#pragma once

#include <string>
#include <vector>

#include "apps/messages/ulog.hpp"
#include "apps/tables/topics/choice.hpp"

namespace splinecast::apps {

/// The name of a topic of a ULog: `sensor_combined`, or `actuator_outputs:1` for an instance other
/// than 0.
[[nodiscard]] std::string name_of(const ulog::Topic& topic);

/// A topic's name without the suffix `:0`.
[[nodiscard]] std::string without_first_instance(const std::string& name);

/// The topics of a log with their numbers of samples, counted in a pass. Samples that cannot be
/// read are not counted. The reader is then at the end of the file.
[[nodiscard]] std::vector<TopicSummary> topics_of(ulog::Reader& reader);

}  // namespace splinecast::apps
