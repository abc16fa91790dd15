#include "apps/tables/topics/mcap_topics.hpp"

#include <algorithm>
#include <map>

#include "apps/process/exit_codes.hpp"
#include "apps/tables/topics/decoder.hpp"

namespace splinecast::apps {
namespace {

using Counts = std::map<std::uint16_t, std::uint64_t>;

/// Counts the messages of each channel up to where the file is damaged.
Counts counted(mcap::Reader& reader) {
  Counts counts;
  mcap::Message message;
  try {
    while (reader.next(message)) ++counts[message.channel->id];
  } catch (const InputError&) {  // the rows before the damage can be read
    reader.rewind();
    return counts;
  }
  reader.rewind();
  return counts;
}

}  // namespace

std::vector<TopicSummary> topics_of(mcap::Reader& reader) {
  const auto& statistics = reader.statistics();
  const bool is_counted = statistics && !statistics->messages_of_channel.empty();
  const Counts counts = is_counted ? statistics->messages_of_channel : counted(reader);
  std::vector<TopicSummary> topics;
  for (const mcap::Channel& channel : reader.channels()) {
    auto found = std::ranges::find_if(
        topics, [&](const TopicSummary& topic) { return is_of(channel, topic); });
    if (found == topics.end()) {
      const bool gives_rows =
          message_type(channel.message_encoding, channel.schema_name) != nullptr;
      topics.push_back({.name = channel.topic,
                        .type = std::string(channel.schema_name),
                        .encoding = channel.message_encoding,
                        .gives_rows = gives_rows});
      found = topics.end() - 1;
    }
    if (const auto count = counts.find(channel.id); count != counts.end()) {
      found->messages += count->second;
    }
  }
  return topics;
}

bool is_of(const mcap::Channel& channel, const TopicSummary& topic) {
  return channel.topic == topic.name && channel.schema_name == topic.type &&
         channel.message_encoding == topic.encoding;
}

}  // namespace splinecast::apps
