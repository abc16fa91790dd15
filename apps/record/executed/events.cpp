#include "apps/record/executed/events.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "apps/files/text_file.hpp"
#include "apps/mcap/input/reader.hpp"

namespace splinecast::apps::record {
namespace {

std::optional<RecordedEvent> parse_event(std::span<const std::byte> message) {
  const auto json = nlohmann::ordered_json::parse(message.begin(), message.end(), nullptr, false);
  if (!json.is_object() || !json.contains("time_ns") || !json.contains("event")) return {};
  if (!json["time_ns"].is_number_integer() || !json["event"].is_string()) return {};
  RecordedEvent event{.time = Time(json["time_ns"].get<std::int64_t>()),
                      .text = json["event"].get<std::string>()};
  for (const auto& [key, value] : json.items()) {
    if (key == "time_ns" || key == "event") continue;
    event.text +=
        fmt::format(", {} {}", key, value.is_string() ? value.get<std::string>() : value.dump());
  }
  return event;
}

}  // namespace

std::vector<RecordedEvent> read_events(const std::string& path, const std::string& stream) {
  const TextFile file(path);
  mcap::Reader reader(file.name(), std::as_bytes(std::span(file.text())));
  const std::string topic = "/" + stream + "/events";
  std::vector<RecordedEvent> events;
  mcap::Message message;
  while (events.size() < kMostEvents && reader.next(message)) {
    if (message.channel->topic != topic) continue;
    if (auto event = parse_event(message.data)) events.push_back(std::move(*event));
  }
  return events;
}

}  // namespace splinecast::apps::record
