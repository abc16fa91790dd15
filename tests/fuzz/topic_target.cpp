#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/messages/bytes.hpp"
#include "apps/messages/message_error.hpp"
#include "apps/messages/ulog.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/tables/topics/decoder.hpp"
#include "apps/tables/ulog/columns.hpp"
#include "splinecast/waypoint.hpp"
#include "tests/fuzz/script.hpp"
#include "tests/fuzz/text_targets.hpp"

namespace splinecast::fuzz {
namespace {

using apps::MessageError;

constexpr std::size_t kLengthBytes = 2;  ///< before each message

std::string_view take_until(std::string_view& text, char end) {
  const std::size_t at = text.find(end);
  const std::string_view part = text.substr(0, at);
  text.remove_prefix(at == std::string_view::npos ? text.size() : at + 1);
  return part;
}

/// Removes a message from a text: its length in two bytes, then its bytes.
std::string_view take_message(std::string_view& text) {
  if (text.size() < kLengthBytes) return {};
  const auto bytes = apps::bytes_of(text);
  const std::size_t length =
      std::to_integer<std::size_t>(bytes[0]) | std::to_integer<std::size_t>(bytes[1]) << 8U;
  const std::string_view message = text.substr(kLengthBytes, length);
  text.remove_prefix(kLengthBytes + message.size());
  return message;
}

/// `ENCODING TYPE KEY=VALUE …`: the options of a topic.
apps::TableOptions options_of(std::string_view line) {
  apps::TableOptions options;
  while (!line.empty()) {
    const std::string_view word = take_until(line, ' ');
    const std::string value(word.substr(std::min(word.find('=') + 1, word.size())));
    if (word.starts_with("field=")) options.fields.push_back(value);
    if (word.starts_with("joint=")) options.joints.push_back(value);
    if (word.starts_with("time=")) options.time_column = value;
    if (word == "log") options.which_time = apps::WhichTime::log;
  }
  return options;
}

void require_whole(const apps::Row& row, std::size_t dimensions) {
  require(row.position.size() == dimensions, "a row has each position");
  for (const auto values : {row.velocity, row.acceleration}) {
    require(values.empty() || values.size() == dimensions, "a row has each derivative, or none");
  }
}

/// Takes all rows that a decoder has. A message has at most as many rows as bytes.
void take_rows(apps::MessageDecoder& decoder, std::size_t most) {
  const std::size_t dimensions = decoder.columns().dimensions();
  require(dimensions >= 1 && dimensions <= kMaxDimensions, "a topic has 1 to 64 dimensions");
  apps::Row row;
  for (std::size_t rows = 0; decoder.next(row); ++rows) {
    require(rows <= most, "a message has no more rows than bytes");
    require_whole(row, dimensions);
  }
}

void try_topic(const apps::MessageType& type, const apps::TableOptions& options,
               std::string_view schema, std::string_view text) {
  std::string_view rest = text;
  const auto first = apps::bytes_of(take_message(rest));
  const auto decoder =
      type.open({.first = {.number = 1, .data = first}, .schema = schema}, options);
  for (const bool surveys : {true, false}) {
    rest = text;
    for (std::uint64_t number = 1; rest.size() >= kLengthBytes; ++number) {
      const apps::TopicMessage message{
          .number = number, .log_time = Time(number), .data = apps::bytes_of(take_message(rest))};
      try {
        if (surveys && decoder->wants_survey()) decoder->survey(message);
        decoder->take(message);
        take_rows(*decoder, text.size());
      } catch (const MessageError&) {
        continue;
      }
    }
    decoder->finish();
    take_rows(*decoder, text.size());
    decoder->rewind();
  }
}

void try_ulog(const apps::TableOptions& options, std::string_view text) {
  apps::ulog::Reader reader(apps::bytes_of(text));
  apps::ulog::Sample sample;
  for (std::size_t messages = 0;; ++messages) {
    require(messages <= text.size(), "a log has no more messages than bytes");
    try {
      if (!reader.next(sample)) return;
      const auto& fields = reader.topics()[sample.topic].fields;
      const apps::UlogColumns columns = apps::ulog_columns(fields, "log", options);
      for (const auto& field : fields) (void)value_of(field, sample.data);
      const auto time = columns.time_of(sample.data);
      require(!time || is_time_in_range(*time), "times are in range");
    } catch (const MessageError&) {
      continue;
    } catch (const apps::InputError&) {
      continue;
    }
  }
}

}  // namespace

void try_topics(std::string_view text) {
  std::string_view line = take_until(text, '\n');
  const std::string_view schema = take_until(text, '\n');
  const std::string_view encoding = take_until(line, ' ');
  const std::string_view name = take_until(line, ' ');
  try {
    const apps::TableOptions options = options_of(line);
    if (encoding == "ulog") return try_ulog(options, text);
    const apps::MessageType* const type = apps::message_type(encoding, name);
    if (type != nullptr) try_topic(*type, options, schema, text);
  } catch (const MessageError&) {
    return;
  } catch (const apps::InputError&) {
    return;
  }
}

}  // namespace splinecast::fuzz
