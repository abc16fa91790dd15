#include "apps/contents/contents.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "apps/files/input_file.hpp"
#include "apps/files/numbers.hpp"
#include "apps/mcap/input/reader.hpp"
#include "apps/messages/bytes.hpp"
#include "apps/messages/json_fields.hpp"
#include "apps/messages/message_error.hpp"
#include "apps/messages/ulog.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/tables/format.hpp"
#include "apps/tables/ulog/topics.hpp"

namespace splinecast::apps {
namespace {

/// Counts the events of the streams that this program recorded.
class EventCounts {
 public:
  explicit EventCounts(FileContents& contents) : contents_(contents) {}

  void take(const mcap::Message& message) {
    if (message.channel->schema_name != "splinecast.Event" || !can_read_json()) return;
    if (!fields_) fields_.emplace(std::vector<JsonPath>{{"event"}, {"reason"}, {"count"}});
    try {
      fields_->read(text_of(message.data));
    } catch (const MessageError&) {
      return;
    }
    const std::string_view event = trimmed(fields_->text(0));
    if (contents_.events.size() < kMostNames) ++contents_.events[std::string(event)];
    if (contents_.event_list.size() < kEventsListed) {
      contents_.event_list.push_back({.log_time = message.log_time,
                                      .publish_time = message.publish_time,
                                      .topic = message.channel->topic,
                                      .text = std::string(text_of(message.data))});
    }
    const bool is_loss = event == "lost" && trimmed(fields_->text(1)) != "late commit";
    if (is_loss) contents_.lost += parse_count(fields_->text(2)).value_or(0);
  }

 private:
  static constexpr std::size_t kMostNames = 100;

  FileContents& contents_;
  std::optional<JsonFields> fields_{};
};

/// Whether `record` wrote a channel. Messages that it saw in one look have the same time.
bool is_recorded_here(const mcap::Channel& channel) noexcept {
  return channel.schema_name.starts_with("splinecast.") || channel.message_encoding == "splinecast";
}

/// Whether this program recorded the file in format 1: then the publish time of a message is when
/// it was seen.
bool is_of_format_1(const mcap::Reader& reader) {
  return std::ranges::any_of(reader.metadata(), [](const mcap::Metadata& metadata) {
    const auto format = metadata.values.find("format");
    return metadata.name.starts_with("splinecast:") && format != metadata.values.end() &&
           format->second == "1";
  });
}

FileContents of_mcap(InputFile& file) {
  FileContents contents{.file = file.name(), .format = "MCAP"};
  mcap::Reader reader(file.name(), bytes_of(file.mapped()));
  struct Times {
    TimeSpans log, publish;
  };
  std::map<const mcap::Channel*, Times> times;
  EventCounts events(contents);
  mcap::Message message;
  try {
    while (reader.next(message)) {
      Times& both = times[message.channel];
      const bool is_own = is_recorded_here(*message.channel);
      both.log.add(message.log_time, is_own);
      both.publish.add(message.publish_time, is_own);
      events.take(message);
    }
  } catch (const InputError& damage) {
    contents.damage = damage.what();
  }
  contents.is_complete = !reader.ended_early() && contents.damage.empty();
  contents.written_by = reader.library();
  const bool is_seen_published = is_of_format_1(reader);
  for (RecordedEvent& event : contents.event_list) {
    if (is_seen_published) event.log_time = event.publish_time;
  }
  for (const mcap::Channel& channel : reader.channels()) {
    const Times& both = times[&channel];
    const bool is_own = is_recorded_here(channel);
    contents.topics.push_back({.name = channel.topic,
                               .type = std::string(channel.schema_name),
                               .encoding = channel.message_encoding,
                               .times = is_own && is_seen_published ? both.publish : both.log});
  }
  for (const mcap::Metadata& metadata : reader.metadata()) {
    contents.metadata.emplace_back(metadata.name, metadata.values);
  }
  return contents;
}

FileContents of_ulog(InputFile& file) {
  FileContents contents{.file = file.name(), .format = "ULog"};
  ulog::Reader reader(bytes_of(file.mapped()));
  std::vector<TimeSpans> times;
  ulog::Sample sample;
  for (bool is_at_end = false; !is_at_end;) {
    try {
      is_at_end = !reader.next(sample);
      if (is_at_end) break;
      times.resize(std::max(times.size(), sample.topic + 1));
      constexpr std::uint64_t kMost = std::uint64_t{1} << 52U;  // fits as nanoseconds
      times[sample.topic].add(std::chrono::microseconds(std::min(sample.microseconds, kMost)));
    } catch (const MessageError& bad) {
      if (contents.damage.empty()) contents.damage = bad.what();
    }
  }
  times.resize(reader.topics().size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    contents.topics.push_back({.name = name_of(reader.topics()[i]), .times = times[i]});
  }
  contents.is_complete = !reader.ended_early() && contents.damage.empty();
  contents.dropouts = reader.dropouts().count;
  contents.dropped = std::chrono::milliseconds(reader.dropouts().milliseconds);
  std::map<std::string, std::string> information;
  for (const auto& [key, text] : reader.information()) information.emplace(key, text);
  if (!information.empty()) contents.metadata.emplace_back("information", information);
  return contents;
}

FileContents of_table(InputFile file) {
  const auto rows = InputFormat::open(std::move(file), {.quiet = true});
  FileContents contents{.file = rows->name(), .format = "table"};
  contents.columns = rows->columns().names;
  contents.bad_rows = 0;
  TopicContents table{.name = "rows"};
  Row row;
  for (bool is_at_end = false; !is_at_end;) {
    try {
      is_at_end = !rows->next(row);
      if (!is_at_end) table.times.add(row.time);
    } catch (const InputError& bad) {
      if (contents.damage.empty()) contents.damage = bad.what();
      ++*contents.bad_rows;
      is_at_end = row.number == 0;
    }
  }
  contents.topics.push_back(std::move(table));
  return contents;
}

}  // namespace

FileContents contents_of(const std::string& path) {
  InputFile file(path);
  std::array<char, 16> beginning{};
  const std::string_view begin(beginning.data(), file.read(0, beginning));
  if (!begin.empty() && mcap::is_mcap(bytes_of(begin))) return of_mcap(file);
  if (ulog::is_ulog(bytes_of(begin))) {
    try {
      return of_ulog(file);
    } catch (const MessageError& bad) {
      throw InputError(file.name() + ": " + bad.what());
    }
  }
  return of_table(std::move(file));
}

}  // namespace splinecast::apps
