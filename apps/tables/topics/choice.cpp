#include "apps/tables/topics/choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"

namespace splinecast::apps {
namespace {

constexpr std::string_view kWaypoints = "/waypoints";
constexpr std::string_view kExact = "/splinecast";  ///< each recorded stream has such a topic
constexpr std::size_t kMostListed = 50;

std::string list_of(const std::vector<TopicSummary>& topics) {
  std::string text;
  for (std::size_t i = 0; i < std::min(topics.size(), kMostListed); ++i) {
    const TopicSummary& topic = topics[i];
    const std::string kind =
        topic.encoding.empty()
            ? topic.type
            : fmt::format("{}, {}", topic.type.empty() ? "no schema" : topic.type, topic.encoding);
    text +=
        fmt::format("\n  {} ({}): {} message{}{}", shown(topic.name), shown(kind), topic.messages,
                    topic.messages == 1 ? "" : "s", topic.gives_rows ? "" : ", no waypoints");
  }
  if (topics.size() > kMostListed) {
    text += fmt::format("\n  and {} more", topics.size() - kMostListed);
  }
  return text;
}

/// Whether a topic has the waypoints of a stream that this program recorded.
bool is_recorded(const std::vector<TopicSummary>& topics, const TopicSummary& topic) {
  if (!topic.name.ends_with(kWaypoints)) return false;
  std::string exact = topic.name.substr(0, topic.name.size() - kWaypoints.size());
  exact += kExact;
  return std::ranges::find(topics, exact, &TopicSummary::name) != topics.end();
}

}  // namespace

const TopicSummary& choose_topic(const std::string& file, const std::vector<TopicSummary>& topics,
                                 const std::string& wanted) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("{}: {}{}", file, why, list_of(topics)));
  };
  if (!wanted.empty()) {
    auto found = std::ranges::find(topics, wanted, &TopicSummary::name);
    if (found == topics.end()) {
      const std::string recorded = fmt::format("/{}{}", wanted, kWaypoints);
      found = std::ranges::find(topics, recorded, &TopicSummary::name);
    }
    if (found == topics.end()) {
      refuse(fmt::format("there is no topic '{}' among", shown(wanted)));
    }
    if (!found->gives_rows) {
      refuse(
          fmt::format("topic '{}' has messages of a type that gives no waypoints; the topics are",
                      shown(wanted)));
    }
    return *found;
  }
  const bool is_recording = std::ranges::any_of(
      topics, [&](const TopicSummary& topic) { return is_recorded(topics, topic); });
  const TopicSummary* chosen = nullptr;
  for (const TopicSummary& topic : topics) {
    const bool fits =
        topic.gives_rows && topic.messages > 0 && (!is_recording || is_recorded(topics, topic));
    if (!fits) continue;
    if (chosen != nullptr) refuse("choose one of the topics with --topic:");
    chosen = &topic;
  }
  if (chosen == nullptr) refuse("no topic has messages that give waypoints; the topics are");
  return *chosen;
}

}  // namespace splinecast::apps
