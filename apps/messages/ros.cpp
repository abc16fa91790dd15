#include "apps/messages/ros.hpp"

#include "apps/process/exit_codes.hpp"

#ifdef SPLINECAST_HAS_FASTCDR

#include "apps/messages/cdr.hpp"

namespace splinecast::apps::ros {
namespace {

constexpr std::uint32_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::size_t kLeastStringBytes = 4;  ///< its length
constexpr std::size_t kLeastPointBytes = 24;  ///< four lengths and a duration

Time time_of(CdrReader& message) {
  const std::int32_t seconds = message.int32();
  const std::uint32_t nanoseconds = message.uint32();
  if (nanoseconds >= kNanosecondsPerSecond) {
    message.fail("the nanoseconds of a time are not below 1000000000", nanoseconds);
  }
  return std::chrono::seconds(seconds) + Time(nanoseconds);
}

Time stamp_of_header(CdrReader& message) {
  const Time stamp = time_of(message);
  (void)message.string();  // frame_id
  return stamp;
}

void read_names(CdrReader& message, std::vector<std::string_view>& names) {
  const std::size_t count = message.length(kLeastStringBytes);
  if (count > kMostJoints) message.fail("more than 4096 joints", count);
  names.resize(count);
  for (auto& name : names) name = message.string();
}

/// One value per joint, or none.
void read_values(CdrReader& message, std::size_t joints, std::vector<double>& values) {
  message.doubles(values);
  if (!values.empty() && values.size() != joints) {
    message.fail("the number of values is not that of the joints", values.size());
  }
}

void read_pose(CdrReader& message, Pose& pose) { message.doubles(pose.values); }

}  // namespace

void decode(Bytes bytes, JointState& state) {
  CdrReader message(bytes);
  state.stamp = stamp_of_header(message);
  read_names(message, state.names);
  read_values(message, state.names.size(), state.positions);
  read_values(message, state.names.size(), state.velocities);
}

void decode(Bytes bytes, JointTrajectory& trajectory) {
  CdrReader message(bytes);
  trajectory.stamp = stamp_of_header(message);
  read_names(message, trajectory.names);
  const std::size_t joints = trajectory.names.size();
  trajectory.points.resize(message.length(kLeastPointBytes));
  std::vector<double> effort;
  for (TrajectoryPoint& point : trajectory.points) {
    read_values(message, joints, point.positions);
    read_values(message, joints, point.velocities);
    read_values(message, joints, point.accelerations);
    message.doubles(effort);
    point.from_start = time_of(message);
  }
}

void decode_pose_stamped(Bytes bytes, Pose& pose) {
  CdrReader message(bytes);
  pose.stamp = stamp_of_header(message);
  read_pose(message, pose);
}

void decode_odometry(Bytes bytes, Pose& pose) {
  CdrReader message(bytes);
  pose.stamp = stamp_of_header(message);
  (void)message.string();  // child_frame_id
  read_pose(message, pose);
}

bool can_decode() noexcept { return true; }

}  // namespace splinecast::apps::ros

#else

namespace splinecast::apps::ros {
namespace {

[[noreturn]] void refuse() {
  throw InputError("this build cannot read CDR (built without libfastcdr; Debian: libfastcdr-dev)");
}

}  // namespace

void decode(Bytes /*message*/, JointState& /*state*/) { refuse(); }
void decode(Bytes /*message*/, JointTrajectory& /*trajectory*/) { refuse(); }
void decode_pose_stamped(Bytes /*message*/, Pose& /*pose*/) { refuse(); }
void decode_odometry(Bytes /*message*/, Pose& /*pose*/) { refuse(); }
bool can_decode() noexcept { return false; }

}  // namespace splinecast::apps::ros

#endif
