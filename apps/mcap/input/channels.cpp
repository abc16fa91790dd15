#include "apps/mcap/input/channels.hpp"

#include <fmt/format.h>

#include <tuple>

namespace splinecast::apps::mcap {

void DescriptionMemory::take(const Source& source, const Record& record, std::size_t bytes,
                             std::size_t keys) {
  constexpr std::size_t kMost = std::size_t{32} << 20U;
  constexpr std::size_t kRecordCost = 512;
  constexpr std::size_t kKeyCost = 128;
  used_ += bytes + kRecordCost + kKeyCost * keys;
  if (used_ > kMost) {
    source.refuse(record.offset,
                  fmt::format("schemas, channels and metadata need more than {} bytes", kMost));
  }
}

bool Channels::add_schema(const Source& source, const Record& record, DescriptionMemory& memory) {
  const SchemaFields fields = parse_schema(source, record);
  if (fields.id == 0) return false;  // to be ignored, by the specification
  const auto known = schemas_.find(fields.id);
  if (known == schemas_.end()) {
    memory.take(source, record, record.content.size(), 0);
    schemas_.try_emplace(fields.id, Schema{std::string(fields.name), std::string(fields.encoding),
                                           std::string(fields.data)});
    return true;
  }
  const Schema& schema = known->second;
  if (std::tie(schema.name, schema.encoding, schema.data) !=
      std::tie(fields.name, fields.encoding, fields.data)) {
    source.refuse(record.offset, fmt::format("schema {} differs from an earlier one", fields.id));
  }
  return false;
}

bool Channels::add_channel(const Source& source, const Record& record, DescriptionMemory& memory) {
  const ChannelFields fields = parse_channel(source, record);
  if (const Channel* const known = find(fields.id)) {
    if (std::tie(known->schema_id, known->topic, known->message_encoding, known->metadata) !=
        std::tie(fields.schema, fields.topic, fields.message_encoding, fields.metadata)) {
      source.refuse(record.offset,
                    fmt::format("channel {} differs from an earlier one", fields.id));
    }
    return false;
  }
  const auto schema = schemas_.find(fields.schema);
  if (fields.schema != 0 && schema == schemas_.end()) {
    source.refuse(record.offset,
                  fmt::format("channel {} has the unknown schema {}", fields.id, fields.schema));
  }
  memory.take(source, record, record.content.size(), fields.metadata.size());
  Channel& channel = channels_.emplace_back(Channel{fields.id,
                                                    fields.schema,
                                                    std::string(fields.topic),
                                                    std::string(fields.message_encoding),
                                                    {},
                                                    {},
                                                    {},
                                                    fields.metadata});
  if (fields.schema != 0) {
    channel.schema_name = schema->second.name;
    channel.schema_encoding = schema->second.encoding;
    channel.schema_data = schema->second.data;
  }
  if (by_id_.size() <= fields.id) by_id_.resize(fields.id + std::size_t{1});
  by_id_[fields.id] = &channel;
  return true;
}

}  // namespace splinecast::apps::mcap
