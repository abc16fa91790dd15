#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/limits/named.hpp"

namespace splinecast::apps {

/// The limits of joints in a file.
struct LimitFile {
  std::vector<NamedLimits> joints;
  std::vector<std::string> notes;  ///< messages about unused parts, with file and line
};

/// Reads MoveIt's joint_limits.yaml or a URDF (a file that begins with `<`). Throws InputError
/// with file, line and value if the file cannot be read, or if this build cannot read its format.
[[nodiscard]] LimitFile read_limit_file(const std::string& path);

/// Read a text in one of the two formats; `name` is the file's, for messages. Internal to
/// read_limit_file().
[[nodiscard]] LimitFile read_joint_limits_yaml(const std::string& name, const std::string& text);
[[nodiscard]] LimitFile read_urdf(const std::string& name, const std::string& text);

/// Throws InputError unless the value of a limit is a number from 0 to 1e100.
[[nodiscard]] double limit_value(const std::string& where, std::string_view what, double value);

}  // namespace splinecast::apps
