#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ipc/layout/header.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps::record {

/// Version of the format. In format 1, the log time of a message is its time on the stream and the
/// publish time when the recorder saw it; there are no accounts, and losses have no numbers.
inline constexpr int kFormat = 2;

/// The options of a stream, as a recording has them.
struct StreamOptions {
  int format = kFormat;  ///< of the file
  std::string stream{};
  ipc::RegionHeader waypoints{};              ///< of the producer's region
  std::optional<ipc::RegionHeader> spline{};  ///< of the solver's region; empty: no solver yet
  Time wall_offset{};  ///< of a live stream: its times plus this are times of the wall clock
};

/// The message of the exact channel and the metadata of a stream are this JSON object. Numbers are
/// written so that they read back exactly.
[[nodiscard]] nlohmann::ordered_json to_json(const StreamOptions& options);

/// Reads what to_json writes, for the layout of this program. Throws BadMessage, naming the field,
/// for another format, a missing field or a value that no stream has.
[[nodiscard]] StreamOptions parse_options(std::string_view text);
/// The same for the body of a message.
[[nodiscard]] StreamOptions parse_options(std::span<const std::byte> body);

/// The names of a stream's dimensions in the JSON channels: those of the header, or their indices
/// if a name is empty or occurs twice.
[[nodiscard]] std::vector<std::string> names_in_json(const ipc::RegionHeader& header);

}  // namespace splinecast::apps::record
