#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/record/verification/recorded_stream.hpp"

namespace splinecast::apps::record {

/// What verification has found in a recording.
struct FileVerification {
  std::string file{};
  bool ended_early = false;  ///< the file is cut off
  std::map<std::string, StreamVerification> streams{};
};

/// Solves the streams of a recording again, from their items and the decisions that their segments
/// show, and compares every segment bit by bit: see ipc::verify. `stream`: the only one to verify;
/// empty: all. Throws InputError, with file and message, for a damaged file, for one without
/// recorded streams, and if `stream` is not in it.
[[nodiscard]] FileVerification verify_file(const std::string& path, const std::string& stream);

/// kFellShort if a segment differs; kIncomplete if something was lost or could not be compared, or
/// if the file has nothing to verify; else kOk.
[[nodiscard]] int exit_code(const FileVerification& found);
[[nodiscard]] std::vector<std::string> to_lines(const FileVerification& found);
[[nodiscard]] nlohmann::ordered_json to_json(const FileVerification& found);

}  // namespace splinecast::apps::record
