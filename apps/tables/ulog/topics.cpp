#include "apps/tables/ulog/topics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "apps/messages/message_error.hpp"

namespace splinecast::apps {
namespace {

/// Takes the next sample that can be read; false at the end.
bool next_sample(ulog::Reader& reader, ulog::Sample& sample) {
  for (;;) {
    try {
      return reader.next(sample);
    } catch (const MessageError&) {  // a reading of rows reports it
      continue;
    }
  }
}

}  // namespace

std::string name_of(const ulog::Topic& topic) {
  return topic.instance == 0 ? topic.name : fmt::format("{}:{}", topic.name, topic.instance);
}

std::string without_first_instance(const std::string& name) {
  constexpr std::string_view kFirst = ":0";
  return name.ends_with(kFirst) ? name.substr(0, name.size() - kFirst.size()) : name;
}

std::vector<TopicSummary> topics_of(ulog::Reader& reader) {
  std::vector<std::uint64_t> counts;
  ulog::Sample sample;
  while (next_sample(reader, sample)) {
    counts.resize(std::max(counts.size(), sample.topic + 1));
    ++counts[sample.topic];
  }
  counts.resize(reader.topics().size());
  std::vector<TopicSummary> topics;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    const ulog::Topic& topic = reader.topics()[i];
    topics.push_back({.name = name_of(topic),
                      .type = fmt::format("{} fields", topic.fields.size()),
                      .encoding = "",
                      .messages = counts[i],
                      .gives_rows = topic.fields.size() > 1});
  }
  return topics;
}

}  // namespace splinecast::apps
