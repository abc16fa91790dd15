#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "splinecast/time.hpp"

/// Messages of ROS 2 in CDR, the encoding of rosbag2: little or big endian, with the encapsulation
/// header. The decoders are built on libfastcdr. Without it they throw InputError, which names the
/// missing package. They check each length against the bytes that are left before they reserve
/// memory, and throw MessageError for a message that does not fit its type.
namespace splinecast::apps::ros {

/// The most joints of a message.
inline constexpr std::size_t kMostJoints = 4096;

/// sensor_msgs/msg/JointState. Views are valid as long as the decoded bytes.
struct JointState {
  Time stamp{};
  std::vector<std::string_view> names{};
  std::vector<double> positions{};   ///< one per name, or none
  std::vector<double> velocities{};  ///< one per name, or none
};

/// A point of a trajectory: each vector has one value per joint, or none.
struct TrajectoryPoint {
  Time from_start{};
  std::vector<double> positions{};
  std::vector<double> velocities{};
  std::vector<double> accelerations{};
};

/// trajectory_msgs/msg/JointTrajectory. Views are valid as long as the decoded bytes.
struct JointTrajectory {
  Time stamp{};
  std::vector<std::string_view> names{};
  std::vector<TrajectoryPoint> points{};
};

/// The pose of a geometry_msgs/msg/PoseStamped or a nav_msgs/msg/Odometry.
struct Pose {
  Time stamp{};
  std::array<double, 7> values{};  ///< x y z qx qy qz qw
};

using Bytes = std::span<const std::byte>;

/// Decode a message. The memory of the result is used again: decoding messages of equal size
/// allocates only at the first one.
void decode(Bytes message, JointState& state);
void decode(Bytes message, JointTrajectory& trajectory);
void decode_pose_stamped(Bytes message, Pose& pose);
/// The twist is not used: it is in the frame of the child, not in that of the pose.
void decode_odometry(Bytes message, Pose& pose);

/// Whether this program can decode CDR.
[[nodiscard]] bool can_decode() noexcept;

}  // namespace splinecast::apps::ros
