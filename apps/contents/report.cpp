#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>
#include <numeric>

#include "apps/contents/contents.hpp"
#include "apps/process/messages.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

ordered_json time_json(std::optional<Time> time) {
  return time ? ordered_json(time->count()) : ordered_json(nullptr);
}

ordered_json topic_json(const TopicContents& topic) {
  ordered_json pauses = ordered_json::array();
  for (const Pause& pause : topic.times.pauses()) {
    pauses.push_back({{"begin_ns", pause.begin.count()}, {"length_ns", pause.length.count()}});
  }
  return {{"topic", topic.name},
          {"type", topic.type},
          {"encoding", topic.encoding},
          {"messages", topic.times.count()},
          {"rate_hz", topic.times.rate()},
          {"first_ns", time_json(topic.times.first())},
          {"last_ns", time_json(topic.times.last())},
          {"not_increasing", topic.times.not_increasing()},
          {"longest_pauses", std::move(pauses)}};
}

/// The first and the last time of all topics.
std::optional<Pause> span_of(const FileContents& contents) {
  std::optional<Time> first;
  std::optional<Time> last;
  for (const TopicContents& topic : contents.topics) {
    if (topic.times.count() == 0) continue;
    first = std::min(first.value_or(*topic.times.first()), *topic.times.first());
    last = std::max(last.value_or(*topic.times.last()), *topic.times.last());
  }
  if (!first) return std::nullopt;
  return Pause{.begin = *first, .length = *last - *first};
}

std::uint64_t messages_of(const FileContents& contents) {
  std::uint64_t messages = 0;
  for (const TopicContents& topic : contents.topics) messages += topic.times.count();
  return messages;
}

std::string line(std::string_view key, const std::string& value) {
  return fmt::format("{:<16}  {}\n", key, value);
}

/// A time in seconds, and its date if it is probably one of the wall clock: after 2001.
std::string time_text(Time time) {
  constexpr Time kFirstDate = std::chrono::seconds(1'000'000'000);
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  std::string text = fmt::format("{}.{:09} s", seconds.count(), (time - seconds).count());
  if (time >= kFirstDate) {
    text += fmt::format(" ({:%FT%TZ})", fmt::gmtime(static_cast<std::time_t>(seconds.count())));
  }
  return text;
}

std::string state_text(const FileContents& contents) {
  if (contents.is_complete) return "yes";
  if (!contents.damage.empty()) return fmt::format("no: damaged: {}", contents.damage);
  return contents.format == "MCAP"
             ? "no: cut off (splinecast recover makes a complete file of its whole part)"
             : "no: cut off";
}

/// The columns of the table of topics: a heading and the cell of each topic.
struct Column {
  std::string_view heading;
  bool is_text = false;
  std::vector<std::string> cells{};

  [[nodiscard]] std::size_t width() const {
    std::size_t width = heading.size();
    for (const std::string& cell : cells) width = std::max(width, cell.size());
    return width;
  }
  [[nodiscard]] bool is_empty() const {
    return std::ranges::all_of(cells, [](const std::string& cell) { return cell.empty(); });
  }
};

std::vector<Column> columns_of(const FileContents& contents) {
  std::vector<Column> columns{{"TOPIC", true}, {"TYPE", true}, {"ENCODING", true},
                              {"MESSAGES"},    {"RATE Hz"},    {"DURATION s"},
                              {"LONGEST s"},   {"AFTER s"},    {"NOT IN ORDER"}};
  const auto span = span_of(contents);
  for (const TopicContents& topic : contents.topics) {
    const TimeSpans& times = topic.times;
    std::vector<std::string> cells{shown(topic.name), shown(topic.type), shown(topic.encoding),
                                   fmt::format("{}", times.count())};
    cells.resize(columns.size());
    if (times.count() > 1) {
      cells[4] = fmt::format("{:.3f}", times.rate());
      cells[5] = fmt::format("{:.6f}", to_seconds(*times.last() - *times.first()));
    }
    if (!times.pauses().empty()) {
      cells[6] = fmt::format("{:.6f}", to_seconds(times.pauses().front().length));
      cells[7] = fmt::format("{:.6f}", to_seconds(times.pauses().front().begin - span->begin));
    }
    if (times.not_increasing() > 0) cells[8] = fmt::format("{}", times.not_increasing());
    for (std::size_t c = 0; c < cells.size(); ++c) columns[c].cells.push_back(std::move(cells[c]));
  }
  std::erase_if(columns, [](const Column& column) { return column.is_empty(); });
  return columns;
}

/// A line per topic. LONGEST is the longest pause, AFTER the time from the file's beginning to it.
std::string topics_text(const FileContents& contents) {
  const std::vector<Column> columns = columns_of(contents);
  std::string text;
  for (std::size_t i = 0; i <= contents.topics.size(); ++i) {
    std::string row;
    for (const Column& column : columns) {
      const std::string_view cell = i == 0 ? column.heading : std::string_view(column.cells[i - 1]);
      row += column.is_text ? fmt::format("{:<{}}  ", cell, column.width())
                            : fmt::format("{:>{}}  ", cell, column.width());
    }
    row.erase(row.find_last_not_of(' ') + 1);
    text += "\n" + row;
  }
  return text + "\n";
}

/// A message in JSON; its text if it is not valid.
ordered_json message_of(const std::string& text) {
  ordered_json message = ordered_json::parse(text, nullptr, false);
  return message.is_discarded() ? ordered_json(text) : message;
}

}  // namespace

ordered_json to_json(const FileContents& contents) {
  const auto span = span_of(contents);
  ordered_json topics = ordered_json::array();
  for (const TopicContents& topic : contents.topics) topics.push_back(topic_json(topic));
  ordered_json json{{"file", contents.file},
                    {"format", contents.format},
                    {"complete", contents.is_complete},
                    {"damage", contents.damage},
                    {"written_by", contents.written_by},
                    {"first_ns", span ? ordered_json(span->begin.count()) : ordered_json(nullptr)},
                    {"duration_ns", span ? span->length.count() : 0},
                    {"messages", messages_of(contents)},
                    {"topics", std::move(topics)}};
  if (contents.bad_rows) {
    json["columns"] = contents.columns;
    json["bad_rows"] = *contents.bad_rows;
  }
  if (contents.dropouts) {
    json["dropouts"] = {{"count", *contents.dropouts}, {"duration_ns", contents.dropped.count()}};
  }
  if (!contents.events.empty()) {
    json["events"] = contents.events;
    json["event_list"] = ordered_json::array();
    for (const RecordedEvent& event : contents.event_list) {
      json["event_list"].push_back({{"log_time_ns", event.log_time.count()},
                                    {"topic", event.topic},
                                    {"message", message_of(event.text)}});
    }
    json["lost"] = contents.lost;
  }
  json["metadata"] = ordered_json::array();
  for (const auto& [name, values] : contents.metadata) {
    json["metadata"].push_back({{"name", name}, {"values", values}});
  }
  return json;
}

std::string events_text(const FileContents& contents) {
  std::string text;
  for (const RecordedEvent& event : contents.event_list) {
    const auto microseconds = std::chrono::floor<std::chrono::microseconds>(event.log_time);
    const auto seconds = std::chrono::floor<std::chrono::seconds>(microseconds);
    text += fmt::format(
        "{:%FT%T}.{:06}Z  {}  {}\n", fmt::gmtime(static_cast<std::time_t>(seconds.count())),
        (microseconds - seconds).count(), ipc::printable(event.topic), ipc::printable(event.text));
  }
  const std::uint64_t all =
      std::accumulate(contents.events.begin(), contents.events.end(), std::uint64_t{0},
                      [](std::uint64_t sum, const auto& entry) { return sum + entry.second; });
  const std::uint64_t more = all - std::min<std::uint64_t>(all, contents.event_list.size());
  return more == 0 ? text : text + fmt::format("and {} more\n", more);
}

std::string to_text(const FileContents& contents) {
  std::string text = line("file", contents.file) + line("format", contents.format);
  if (!contents.written_by.empty()) text += line("written by", shown(contents.written_by));
  if (!contents.bad_rows) text += line("complete", state_text(contents));
  if (const auto span = span_of(contents)) {
    text += line("begins", time_text(span->begin)) +
            line("duration", fmt::format("{:.6f} s", to_seconds(span->length)));
  }
  text += line("messages", fmt::format("{}", messages_of(contents)));
  if (contents.bad_rows) {
    text += line("columns", fmt::format("{}", fmt::join(contents.columns, ", ")));
    text += line("bad rows",
                 contents.damage.empty()
                     ? "0"
                     : fmt::format("{}; the first one: {}", *contents.bad_rows, contents.damage));
  }
  if (contents.dropouts) {
    text += line("dropouts", fmt::format("{}, {:.3f} s in total", *contents.dropouts,
                                         to_seconds(contents.dropped)));
  }
  if (!contents.events.empty()) {
    std::string events;
    for (const auto& [name, count] : contents.events) {
      events += fmt::format("{}{} {}", events.empty() ? "" : ", ", shown(name), count);
    }
    text += line("events", events) + line("lost", fmt::format("{}", contents.lost));
  }
  std::map<std::string, std::map<std::string, std::string>> latest;
  for (const auto& [name, values] : contents.metadata) latest[name] = values;
  for (const auto& [name, values] : latest) {
    for (const auto& [key, value] : values) {
      text += line(shown(name), fmt::format("{}: {}", shown(key), shown(value)));
    }
  }
  return text + topics_text(contents);
}

}  // namespace splinecast::apps
