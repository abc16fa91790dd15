#include "apps/messages/ulog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "apps/messages/bytes.hpp"
#include "apps/messages/message_error.hpp"

namespace splinecast::apps::ulog {
namespace {

constexpr std::array<unsigned char, 7> kMagic{'U', 'L', 'o', 'g', 0x01, 0x12, 0x35};
constexpr std::size_t kFileHeaderBytes = 16;
constexpr std::size_t kRecordHeaderBytes = 3;
constexpr std::size_t kFlagBytes = 40;         ///< of the flag message `B`
constexpr std::size_t kIncompatibleFlags = 8;  ///< their offset
constexpr std::size_t kAppendedOffsets = 16;   ///< their offset
constexpr std::size_t kMostAppended = 3;
constexpr std::size_t kMostTopics = 65536;
constexpr std::size_t kMostInformation = 1000;

/// A number in little-endian order, as on this machine.
template <typename T>
T number_at(std::span<const std::byte> bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.subspan(offset, sizeof value).data(), sizeof value);
  return value;
}

}  // namespace

bool is_ulog(std::span<const std::byte> file) noexcept {
  return file.size() >= kMagic.size() &&
         std::memcmp(file.data(), kMagic.data(), kMagic.size()) == 0;
}

Reader::Reader(std::span<const std::byte> file) : file_(file) {
  if (!is_ulog(file)) fail(0, "not a ULog");
  rewind();
}

void Reader::fail(std::size_t offset, const std::string& what) {
  throw MessageError(fmt::format("byte {}: {}", offset, what));
}

void Reader::rewind() {
  at_ = std::min(kFileHeaderBytes, file_.size());
  ended_early_ = file_.size() < kFileHeaderBytes;
  appended_.clear();
  formats_ = {};
  topics_.clear();
  counts_.clear();
  sizes_.clear();
  ids_.clear();
  dropouts_ = {};
  information_.clear();
}

bool Reader::next_record(Record& record) {
  for (;;) {
    const std::size_t end = appended_.empty() ? file_.size() : appended_.front();
    const std::size_t left = end - at_;
    const bool has_header = left >= kRecordHeaderBytes;
    const std::size_t size = has_header ? number_at<std::uint16_t>(file_, at_) : 0;
    if (has_header && left - kRecordHeaderBytes >= size) {
      record.type = static_cast<char>(file_[at_ + 2]);
      record.offset = at_ + kRecordHeaderBytes;
      record.content = file_.subspan(record.offset, size);
      at_ = record.offset + size;
      return true;
    }
    if (appended_.empty()) {
      ended_early_ = ended_early_ || left > 0;
      return false;
    }
    at_ = end;  // the last message before appended data may be cut off
    appended_.erase(appended_.begin());
  }
}

void Reader::take_flags(const Record& record) {
  constexpr auto kAppended = std::byte{1};
  if (record.content.size() < kFlagBytes) fail(record.offset, "the flags have less than 40 bytes");
  const auto flags = record.content.subspan(kIncompatibleFlags, 8);
  const bool is_known =
      (flags[0] & ~kAppended) == std::byte{0} &&
      std::ranges::all_of(flags.subspan(1), [](std::byte each) { return each == std::byte{0}; });
  if (!is_known) fail(record.offset, "the log has incompatible flags that are not known");
  if ((flags[0] & kAppended) == std::byte{0} || !appended_.empty()) return;
  std::size_t last = at_;
  for (std::size_t i = 0; i < kMostAppended; ++i) {
    const auto offset = number_at<std::uint64_t>(record.content, kAppendedOffsets + 8 * i);
    if (offset == 0) break;
    if (offset < last || offset > file_.size()) {
      ended_early_ = true;  // the appended data are beyond the end of the file
      break;
    }
    appended_.push_back(offset);
    last = offset;
  }
}

void Reader::take_information(const Record& record) {
  if (record.content.empty() || information_.size() == kMostInformation) return;
  const auto length = std::to_integer<std::size_t>(record.content[0]);
  if (length >= record.content.size()) fail(record.offset, "a key is longer than its message");
  const std::string_view key = text_of(record.content.subspan(1, length));
  const std::size_t blank = key.find(' ');
  if (!key.starts_with("char[") || blank == std::string_view::npos) return;
  information_.emplace_back(key.substr(blank + 1), text_of(record.content.subspan(1 + length)));
}

void Reader::take_subscription(const Record& record) {
  constexpr std::size_t kNameAt = 3;
  if (record.content.size() <= kNameAt) fail(record.offset, "a subscription without a name");
  const auto id = number_at<std::uint16_t>(record.content, 1);
  const std::string_view name = text_of(record.content.subspan(kNameAt));
  if (topics_.size() == kMostTopics) fail(record.offset, "more than 65536 subscriptions");
  Topic topic{.name = std::string(name),
              .instance = std::to_integer<unsigned>(record.content[0]),
              .fields = {}};
  try {
    topic.fields = formats_.fields(name);
  } catch (const MessageError& bad) {
    fail(record.offset, bad.what());
  }
  const bool has_time = !topic.fields.empty() && topic.fields.front().path == "timestamp" &&
                        topic.fields.front().type == FieldType::uint64 &&
                        topic.fields.front().offset == 0;
  if (!has_time) {
    fail(record.offset, fmt::format("topic '{}': the first field is not uint64_t timestamp", name));
  }
  if (ids_.size() <= id) ids_.resize(std::size_t{id} + 1);
  ids_[id] = topics_.size();
  sizes_.push_back(Formats::size(topic.fields));
  counts_.push_back(0);
  topics_.push_back(std::move(topic));
}

bool Reader::take_sample(const Record& record, Sample& sample) {
  constexpr std::size_t kIdBytes = 2;
  if (record.content.size() < kIdBytes) fail(record.offset, "a sample without a message id");
  const auto id = number_at<std::uint16_t>(record.content, 0);
  if (id >= ids_.size() || !ids_[id]) {
    fail(record.offset, fmt::format("a sample of message id {}, which has no subscription", id));
  }
  const std::size_t topic = *ids_[id];
  const auto data = record.content.subspan(kIdBytes);
  ++counts_[topic];
  if (data.size() < sizes_[topic]) {
    fail(record.offset, fmt::format("a sample of '{}' has {} bytes instead of {}",
                                    topics_[topic].name, data.size(), sizes_[topic]));
  }
  sample = {.topic = topic,
            .microseconds = number_at<std::uint64_t>(data, 0),
            .data = data,
            .number = counts_[topic]};
  return true;
}

/// Takes a message that is not a sample.
void Reader::take(const Record& record) {
  switch (record.type) {
    case 'B':
      return take_flags(record);
    case 'F':
      try {
        formats_.add(text_of(record.content));
      } catch (const MessageError& bad) {
        fail(record.offset, bad.what());
      }
      return;
    case 'I':
      return take_information(record);
    case 'A':
      return take_subscription(record);
    case 'O':
      ++dropouts_.count;
      if (record.content.size() >= 2) {
        dropouts_.milliseconds += number_at<std::uint16_t>(record.content, 0);
      }
      return;
    default:
      return;
  }
}

bool Reader::next(Sample& sample) {
  Record record;
  while (next_record(record)) {
    if (record.type == 'D') return take_sample(record, sample);
    take(record);
  }
  return false;
}

}  // namespace splinecast::apps::ulog
