#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "apps/mcap/input/reader.hpp"

/// The messages of the exact channels, `/NAME/splinecast`, of a file.
namespace splinecast::apps::record {

/// Whether a path is a regular file in the format MCAP, by its first bytes; and whether it is one
/// that `record` wrote, by its first messages. False if it cannot be read.
[[nodiscard]] bool is_mcap_file(const std::string& path);
[[nodiscard]] bool is_recording(const std::string& path);

/// What a file with exact channels is like as a whole.
struct ExactFile {
  std::string name;          ///< safe to print
  bool ended_early = false;  ///< it is cut off
  bool has_messages = false;
};

using TakeExact = std::function<void(std::string_view stream, const mcap::Message& message)>;

/// Calls `take` for the messages of the exact channels, in the order of the file: of `stream`, or
/// of all streams if that is empty. Throws InputError, with file and message, for a damaged file
/// and if `take` throws BadMessage.
ExactFile read_exact(const std::string& path, const std::string& stream, const TakeExact& take);

}  // namespace splinecast::apps::record
