#include "apps/tables/topics/decoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "splinecast/waypoint.hpp"

namespace splinecast::apps {
namespace {

constexpr std::array<MessageType, 6> kTypes{
    {{"cdr", "sensor_msgs/msg/JointState", open_joint_state},
     {"cdr", "trajectory_msgs/msg/JointTrajectory", open_joint_trajectory},
     {"cdr", "geometry_msgs/msg/PoseStamped", open_pose_stamped},
     {"cdr", "nav_msgs/msg/Odometry", open_odometry},
     {"json", "splinecast.Waypoint", open_recorded_stream},
     {"json", "", open_json}}};

}  // namespace

const MessageType* message_type(std::string_view encoding, std::string_view schema) {
  const auto* const found = std::ranges::find_if(kTypes, [&](const MessageType& type) {
    return type.encoding == encoding && (type.name.empty() || type.name == schema);
  });
  return found == kTypes.end() ? nullptr : found;
}

Time time_of(const TopicMessage& message, Time stamp, WhichTime which) noexcept {
  switch (which) {
    case WhichTime::header:
      return stamp;
    case WhichTime::log:
      return message.log_time;
    case WhichTime::publish:
      return message.publish_time;
  }
  return stamp;
}

std::string name_of_time(WhichTime which, std::string_view header) {
  if (which == WhichTime::header) return std::string(header);
  return which == WhichTime::log ? "log time" : "publish time";
}

std::vector<std::string> chosen_names(const TableOptions& options) {
  std::vector<std::string> names;
  for (const auto* chosen : {&options.joints, &options.fields, &options.columns}) {
    if (!chosen->empty() && !names.empty()) {
      throw InputError("give only one of --joints, --field and --columns");
    }
    if (!chosen->empty()) names = *chosen;
  }
  if (names.size() > kMaxDimensions) {
    throw InputError(
        fmt::format("{} dimensions are chosen; the maximum is {}", names.size(), kMaxDimensions));
  }
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (std::find(names.begin(), name, *name) != name) {
      throw InputError(fmt::format("'{}' is chosen twice", shown(*name)));
    }
  }
  return names;
}

}  // namespace splinecast::apps
