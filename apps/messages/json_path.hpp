#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace splinecast::apps {

/// The path of a value in a JSON message: the keys of objects and the indexes of arrays from the
/// root on.
using JsonPath = std::vector<std::string>;

/// The longest JSON message, in bytes.
inline constexpr std::size_t kLongestJson = std::size_t{1} << 20U;

/// Parses `pose.position.x`, `joints[0]` or `joints.0`; a key that contains dots or brackets is
/// written `["a.b"]`. Throws InputError for any other text, and for more than 32 steps.
[[nodiscard]] JsonPath parse_json_path(std::string_view text);

/// The text of a path, which parse_json_path() parses to the same path.
[[nodiscard]] std::string to_string(const JsonPath& path);

/// The numbers in a JSON message, in its order. Throws MessageError if it is not JSON or longer
/// than kLongestJson. Leaves out numbers below the 32nd level.
[[nodiscard]] std::vector<JsonPath> paths_of_numbers(std::string_view message);

}  // namespace splinecast::apps
