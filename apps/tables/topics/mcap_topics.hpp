#pragma once

#include <span>
#include <vector>

#include "apps/mcap/input/reader.hpp"
#include "apps/tables/topics/choice.hpp"

namespace splinecast::apps {

/// The topics of a file, with their numbers of messages: those of its summary, or else counted in a
/// pass over the file, up to where it is damaged. The reader is then at its first message. Channels
/// with the same topic, type and encoding are one topic.
[[nodiscard]] std::vector<TopicSummary> topics_of(mcap::Reader& reader);

/// Whether a channel is of this topic.
[[nodiscard]] bool is_of(const mcap::Channel& channel, const TopicSummary& topic);

}  // namespace splinecast::apps
