#include "apps/record/verification/verify_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

#include "apps/files/text_file.hpp"
#include "apps/mcap/input/reader.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/streams/log.hpp"
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

/// Whether anything could be verified.
bool has_equal(const FileVerification& found) {
  return std::ranges::any_of(found.streams,
                             [](const auto& entry) { return entry.second.equal > 0; });
}

ipc::Verification result_of(const StreamVerification& stream) {
  return {.equal = stream.equal, .first = stream.first};
}

std::string line_of(const StreamVerification& stream) {
  const std::uint64_t rest = stream.unverified();
  std::string line = stream.segments == 0 ? "nothing to verify: no segment in the file"
                     : stream.equal == 0 && !stream.first ? "nothing could be verified"
                                                          : in_words(result_of(stream));
  if (rest > 0 && !stream.first) {
    line += fmt::format("; {} not verified: what they depend on is not in the file", rest);
  }
  if (stream.all_lost().all() > 0) line += fmt::format("; {}", lost_in_words(stream.lost));
  if (stream.unaccounted > 0) {
    line +=
        fmt::format("; {} items are neither in the file nor counted as lost", stream.unaccounted);
  }
  return line;
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

FileVerification verify_file(const std::string& path, const std::string& stream) {
  const TextFile file(path);
  mcap::Reader reader(file.name(), std::as_bytes(std::span(file.text())));
  std::map<std::string, RecordedStream, std::less<>> streams;
  mcap::Message message;
  while (reader.next(message)) {
    const std::string_view name = stream_of(*message.channel);
    if (name.empty() || (!stream.empty() && name != stream)) continue;
    auto found = streams.find(name);
    if (found == streams.end()) found = streams.try_emplace(std::string(name)).first;
    try {
      found->second.take(message.data);
    } catch (const BadMessage& error) {
      refuse(path, message, error);
    }
  }
  FileVerification found{.file = file.name(), .ended_early = reader.ended_early()};
  for (auto& [name, recorded] : streams) {
    recorded.finish();
    found.streams.emplace(name, recorded.found());
  }
  if (found.streams.empty()) {
    throw InputError(stream.empty() ? fmt::format("{}: it has no stream that 'record' wrote",
                                                  ipc::printable(path))
                                    : fmt::format("{}: it has no recorded stream '{}'",
                                                  ipc::printable(path), ipc::printable(stream)));
  }
  return found;
}

int exit_code(const FileVerification& found) {
  const bool differs = std::ranges::any_of(
      found.streams, [](const auto& entry) { return entry.second.first.has_value(); });
  const bool is_complete = std::ranges::all_of(
      found.streams, [](const auto& entry) { return entry.second.is_complete(); });
  return differs ? kFellShort : is_complete && has_equal(found) ? kOk : kIncomplete;
}

std::vector<std::string> to_lines(const FileVerification& found) {
  std::vector<std::string> lines;
  if (found.ended_early) {
    lines.push_back(fmt::format("{}: it is cut off; its whole part is verified", found.file));
  }
  for (const auto& [name, stream] : found.streams) {
    lines.push_back(fmt::format("'{}': {}", name, line_of(stream)));
  }
  return lines;
}

nlohmann::ordered_json to_json(const FileVerification& found) {
  nlohmann::ordered_json streams = nlohmann::ordered_json::object();
  for (const auto& [name, stream] : found.streams) {
    nlohmann::ordered_json json = apps::to_json(result_of(stream));
    json["segments"] = stream.segments;
    json["unverified"] = stream.unverified();
    json["parts"] = stream.parts;
    json["late_commits"] = stream.late_commits;
    json["items"] = stream.items;
    json["sent"] = stream.sent ? nlohmann::ordered_json(*stream.sent) : nullptr;
    json["unaccounted"] = stream.unaccounted;
    json["lost"] = record::to_json(stream.all_lost());
    json["reasons"] = reasons_json(stream.lost);
    streams[name] = std::move(json);
  }
  return {{"file", found.file}, {"ended_early", found.ended_early}, {"streams", streams}};
}

}  // namespace splinecast::apps::record
