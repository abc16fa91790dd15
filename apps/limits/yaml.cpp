#include "apps/limits/file.hpp"
#include "apps/process/exit_codes.hpp"

#ifdef SPLINECAST_HAS_YAML_CPP

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <optional>
#include <set>

#include "apps/files/numbers.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {
namespace {

/// Keys of a joint that do not concern its motion.
const std::set<std::string, std::less<>> kOtherKeys{
    "has_effort_limits", "max_effort", "angle_wraparound", "has_soft_limits",
    "k_position",        "k_velocity", "soft_lower_limit", "soft_upper_limit"};

const std::set<std::string, std::less<>> kJointKeys{
    "has_velocity_limits", "max_velocity",    "has_acceleration_limits",
    "max_acceleration",    "has_jerk_limits", "max_jerk",
    "has_position_limits", "min_position",    "max_position"};

class Reader {
 public:
  explicit Reader(const std::string& name) : name_(name) {}

  LimitFile read(const std::string& text) {
    const YAML::Node root = YAML::Load(text);
    if (!root.IsMap() || !root["joint_limits"]) {
      throw InputError(name_ + ": there is no map 'joint_limits'");
    }
    const double velocity_share = scaling(root, "default_velocity_scaling_factor");
    const double acceleration_share = scaling(root, "default_acceleration_scaling_factor");
    for (const auto& entry : root) {
      const auto key = entry.first.Scalar();
      if (key == "joint_limits" || key == "default_velocity_scaling_factor" ||
          key == "default_acceleration_scaling_factor") {
        continue;
      }
      note(entry.first, fmt::format("unknown key '{}'", key));
    }
    const YAML::Node joints = root["joint_limits"];
    if (!joints.IsMap()) refuse(joints, "'joint_limits' is not a map of joints");
    for (const auto& entry : joints) {
      const auto joint = entry.first.Scalar();
      if (!entry.second.IsMap()) {
        note(entry.first, fmt::format("'{}' is not a joint with limits", joint));
        continue;
      }
      if (!seen_.insert(joint).second) {
        refuse(entry.first, fmt::format("joint '{}' occurs twice", joint));
      }
      NamedLimits limits = joint_limits(joint, entry.second);
      limits.velocity *= velocity_share;
      limits.acceleration *= acceleration_share;
      file_.joints.push_back(std::move(limits));
    }
    return std::move(file_);
  }

 private:
  [[nodiscard]] std::string where(const YAML::Node& node) const {
    return fmt::format("{}:{}", name_, node.Mark().line + 1);
  }

  [[noreturn]] void refuse(const YAML::Node& node, const std::string& why) const {
    throw InputError(where(node) + ": " + why);
  }

  void note(const YAML::Node& node, const std::string& what) {
    file_.notes.push_back(where(node) + ": " + what);
  }

  [[nodiscard]] double number(const YAML::Node& node, std::string_view key) const {
    const std::string text = node.IsScalar() ? node.Scalar() : "a list or map";
    const auto value = parse_number(text);
    if (!value || !is_usable(*value)) {
      refuse(node, fmt::format("{}: '{}' is not a number from -1e100 to 1e100", key, text));
    }
    return *value;
  }

  [[nodiscard]] double scaling(const YAML::Node& root, const std::string& key) const {
    if (!root[key]) return 1;
    const double value = number(root[key], key);
    if (value > 0 && value <= 1) return value;
    refuse(root[key], fmt::format("{}: {} must be above 0 and at most 1", key, value));
  }

  /// The value of a key; nothing if the key is missing, or if the key `has` is false.
  [[nodiscard]] std::optional<double> value(const YAML::Node& joint, const std::string& has,
                                            const std::string& key) const {
    if (joint[has]) {
      bool is_limited = false;
      if (!YAML::convert<bool>::decode(joint[has], is_limited)) {
        refuse(joint[has], has + " is neither true nor false");
      }
      if (!is_limited) return std::nullopt;
    }
    if (joint[key]) return number(joint[key], key);
    return std::nullopt;
  }

  [[nodiscard]] double magnitude(const YAML::Node& joint, const std::string& kind) const {
    const std::string has = "has_" + kind + "_limits";
    const std::string key = "max_" + kind;
    const auto most = value(joint, has, key);
    if (most && *most > 0) return *most;
    if (most) refuse(joint[key], fmt::format("{}: {} is not above 0", key, *most));
    if (joint[has] && joint[has].as<bool>()) refuse(joint[has], "there is no " + key);
    return 0;
  }

  NamedLimits joint_limits(const std::string& name, const YAML::Node& joint) {
    for (const auto& entry : joint) {
      const auto key = entry.first.Scalar();
      if (kJointKeys.contains(key) || kOtherKeys.contains(key)) continue;
      note(entry.first, fmt::format("unknown key '{}' of joint '{}'", key, name));
    }
    NamedLimits limits{.name = name,
                       .velocity = magnitude(joint, "velocity"),
                       .acceleration = magnitude(joint, "acceleration"),
                       .jerk = magnitude(joint, "jerk")};
    limits.lower = value(joint, "has_position_limits", "min_position").value_or(limits.lower);
    limits.upper = value(joint, "has_position_limits", "max_position").value_or(limits.upper);
    if (limits.lower >= limits.upper) {
      refuse(joint["min_position"], fmt::format("min_position {} is not below max_position {}",
                                                limits.lower, limits.upper));
    }
    return limits;
  }

  const std::string& name_;
  std::set<std::string> seen_;
  LimitFile file_;
};

}  // namespace

LimitFile read_joint_limits_yaml(const std::string& name, const std::string& text) {
  try {
    return Reader(name).read(text);
  } catch (const YAML::Exception& error) {
    const int line = std::max(error.mark.line, 0) + 1;
    throw InputError(fmt::format("{}:{}: {}", name, line, error.msg));
  }
}

}  // namespace splinecast::apps

#else

namespace splinecast::apps {

LimitFile read_joint_limits_yaml(const std::string& name, const std::string& /*text*/) {
  throw InputError(name + ": this build cannot read YAML (built without yaml-cpp)");
}

}  // namespace splinecast::apps

#endif
