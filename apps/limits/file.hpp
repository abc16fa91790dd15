#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/limits/named.hpp"

namespace splinecast::apps {

/// What a file says of the limits of joints.
struct LimitFile {
  std::vector<NamedLimits> joints;
  std::vector<std::string> notes;  ///< parts that are not used, with file and line
};

/// Reads MoveIt's joint_limits.yaml or a URDF (a file that begins with `<`). Throws InputError,
/// naming file, line and value, for a file that cannot be read, and where this build cannot read
/// files of its kind.
[[nodiscard]] LimitFile read_limit_file(const std::string& path);

/// The two kinds, of a text; `name` is the file's, for messages. Internal to `read_limit_file`.
[[nodiscard]] LimitFile read_joint_limits_yaml(const std::string& name, const std::string& text);
[[nodiscard]] LimitFile read_urdf(const std::string& name, const std::string& text);

/// Throws InputError unless the value of a limit is a number from 0 to 1e100.
[[nodiscard]] double limit_value(const std::string& where, std::string_view what, double value);

}  // namespace splinecast::apps
