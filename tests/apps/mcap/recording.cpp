#include "tests/apps/mcap/recording.hpp"

namespace splinecast::testing {

namespace mcap = apps::mcap;

SmallRecording::SmallRecording(mcap::Compression compression, bool is_finished) {
  MemoryFileWriter out({.profile = "test", .compression = compression});
  mcap::Writer& writer = out.writer;
  const auto schema = writer.add_schema("waypoint", "jsonschema", R"({"type":"object"})");
  const auto plain = writer.add_channel(0, "/plain", "text");
  const auto described = writer.add_channel(schema, "/described", "json", {{"unit", "rad"}});
  for (std::uint32_t i = 0; i < 9; ++i) {
    const bool is_plain = i % 2 == 0;
    const KeptMessage message{is_plain ? "/plain" : "/described", i, 1000 + i, 500 + i,
                              std::string(i * std::size_t{7}, static_cast<char>('a' + i))};
    writer.write(is_plain ? plain : described, i, Time(message.log_time),
                 Time(message.publish_time), bytes_of(message.data));
    messages.push_back(message);
    if (i % 3 != 2) continue;
    writer.end_chunk();
    if (i == 5) writer.add_metadata("stream", {{"name", "arm"}, {"rate", "100"}});
  }
  if (is_finished) writer.finish();
  file = out.file;
}

std::vector<std::size_t> ends_of(const std::string& file, mcap::Opcode opcode) {
  std::vector<std::size_t> ends;
  mcap::Records records({"file", bytes_of(file)}, mcap::kMagic.size());
  for (mcap::Record record; records.next(record);) {
    if (record.opcode == opcode) ends.push_back(records.offset());
  }
  return ends;
}

std::span<const std::byte> bytes_of(const std::string& file) {
  return std::as_bytes(std::span(file));
}

std::vector<KeptMessage> messages_of(const std::string& file) {
  mcap::Reader reader("file", bytes_of(file));
  return rest_of(reader);
}

std::vector<KeptMessage> rest_of(mcap::Reader& reader) {
  std::vector<KeptMessage> messages;
  mcap::Message message;
  while (reader.next(message)) {
    KeptMessage& kept = messages.emplace_back();
    kept.topic = message.channel->topic;
    kept.sequence = message.sequence;
    kept.log_time = message.log_time.count();
    kept.publish_time = message.publish_time.count();
    for (const std::byte byte : message.data) kept.data.push_back(static_cast<char>(byte));
  }
  return messages;
}

Recovered recover_text(const std::string& file) {
  Recovered recovered;
  recovered.report = mcap::recover("file", bytes_of(file), [&](std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) recovered.file.push_back(static_cast<char>(byte));
    return true;
  });
  return recovered;
}

}  // namespace splinecast::testing
