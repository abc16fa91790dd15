#include "apps/record/verification/verify_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string_view>

#include "apps/process/exit_codes.hpp"
#include "apps/record/executed/exact_messages.hpp"
#include "apps/streams/log.hpp"
#include "ipc/memory/names.hpp"

namespace splinecast::apps::record {
namespace {

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

}  // namespace

FileVerification verify_file(const std::string& path, const std::string& stream) {
  std::map<std::string, RecordedStream, std::less<>> streams;
  const ExactFile file = read_exact(path, stream, [&](std::string_view name, const auto& message) {
    auto found = streams.find(name);
    if (found == streams.end()) found = streams.try_emplace(std::string(name)).first;
    found->second.take(message.data);
  });
  FileVerification found{.file = file.name, .ended_early = file.ended_early};
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
