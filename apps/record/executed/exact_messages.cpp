#include "apps/record/executed/exact_messages.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <span>

#include "apps/files/text_file.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/record/format/bytes.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps::record {
namespace {

constexpr std::string_view kExactEncoding = "splinecast";

/// The name of the stream of an exact channel: `/NAME/splinecast`; empty for other channels.
std::string_view stream_of(const mcap::Channel& channel) noexcept {
  constexpr std::string_view kEnd = "/splinecast";
  std::string_view topic = channel.topic;
  if (channel.message_encoding != kExactEncoding || !topic.starts_with('/') ||
      !topic.ends_with(kEnd) || topic.size() <= kEnd.size() + 1) {
    return {};
  }
  topic.remove_prefix(1);
  topic.remove_suffix(kEnd.size());
  return topic;
}

[[noreturn]] void refuse(const std::string& file, const mcap::Message& message,
                         const BadMessage& error) {
  throw InputError(fmt::format("{}: message {} of {}: {}", ipc::printable(file), message.number,
                               ipc::printable(message.channel->topic), error.what()));
}

/// Whether a path is a regular MCAP file for which `look` returns true. False if it cannot be read.
bool looks(const std::string& path, const std::function<bool(mcap::Reader& reader)>& look) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;  // a pipe can be read only once
  try {
    const TextFile file(path);
    const auto bytes = std::as_bytes(std::span(file.text()));
    if (!mcap::is_mcap(bytes)) return false;
    mcap::Reader reader(file.name(), bytes);
    return look(reader);
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

bool is_mcap_file(const std::string& path) {
  return looks(path, [](mcap::Reader& /*reader*/) { return true; });
}

bool is_recording(const std::string& path) {
  return looks(path, [](mcap::Reader& reader) {
    constexpr int kMostLooked = 1000;
    mcap::Message message;
    for (int i = 0; i < kMostLooked && reader.next(message); ++i) {
      if (message.channel->message_encoding == kExactEncoding) return true;
    }
    return false;
  });
}

ExactFile read_exact(const std::string& path, const std::string& stream, const TakeExact& take) {
  const TextFile file(path);
  mcap::Reader reader(file.name(), std::as_bytes(std::span(file.text())));
  ExactFile found{.name = file.name()};
  mcap::Message message;
  while (reader.next(message)) {
    const std::string_view name = stream_of(*message.channel);
    if (name.empty() || (!stream.empty() && name != stream)) continue;
    found.has_messages = true;
    try {
      take(name, message);
    } catch (const BadMessage& error) {
      refuse(path, message, error);
    }
  }
  found.ended_early = reader.ended_early();
  return found;
}

}  // namespace splinecast::apps::record
