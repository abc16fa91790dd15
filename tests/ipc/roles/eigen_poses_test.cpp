#include <gtest/gtest.h>

#include <vector>

#include "splinecast/eigen.hpp"
#include "tests/fixtures/streams/recorded_roles.hpp"

/// Poses and rotations of Eigen as waypoints of quaternions, on real streams.
namespace splinecast {
namespace {

using testing::kPace;
using testing::RecordedRoles;

/// Poses that turn and move.
Eigen::Isometry3d pose_at(int i) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(0.1 * i, 1, -0.2 * i));
  pose.rotate(Eigen::AngleAxisd(0.05 * i, Eigen::Vector3d(1, 2, 3).normalized()));
  return pose;
}

void poses_are_interpolated(DimensionKind kind) {
  std::vector<Dimension> kinds(3);
  kinds.resize(7, {.kind = kind});
  RecordedRoles stream(7, kinds);
  for (int i = 1; i <= 20; ++i) {
    const Eigen::Isometry3d pose = pose_at(i);
    ASSERT_EQ(kind == DimensionKind::quaternion
                  ? stream.producer.append(as_waypoint(stream.next(), pose))
                  : stream.producer.append(as_waypoint(stream.next(), as_pose(pose, kind))),
              AppendStatus::accepted);
  }
  Reader& reader = stream.finish();
  State state(7);
  for (int i = 1; i <= 20; ++i) {
    ASSERT_TRUE(has_values(reader.sample(i * kPace, state)));
    EXPECT_TRUE(as_isometry(state.position(), kind).isApprox(pose_at(i), 1e-12)) << i;
    const auto rotation = as_quaternion(state.position().last(4), kind);
    EXPECT_LT(rotation.angularDistance(Eigen::Quaterniond(pose_at(i).linear())), 1e-7) << i;
  }
}

TEST(EigenPoses, PosesAreAppendedAndReadBack) {
  poses_are_interpolated(DimensionKind::quaternion);
  poses_are_interpolated(DimensionKind::quaternion_wxyz);
}

TEST(EigenPoses, AQuaternionIsAWaypointOfFourDimensions) {
  const std::vector<Dimension> kinds(4, {.kind = DimensionKind::quaternion});
  RecordedRoles stream(4, kinds);
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()));
  EXPECT_EQ(stream.producer.append(as_waypoint(stream.next(), Eigen::Quaterniond::Identity())),
            AppendStatus::accepted);
  EXPECT_EQ(stream.producer.append(as_waypoint(stream.next(), turned)), AppendStatus::accepted);
  EigenState<4> state;
  ASSERT_TRUE(has_values(stream.finish().sample(2 * kPace, state)));
  EXPECT_TRUE(as_quaternion(state.position).isApprox(turned, 1e-12));
  const Waypoint waypoint = as_waypoint(Time(1), turned.coeffs());
  EXPECT_EQ(waypoint.position.data(), turned.coeffs().data());
}

}  // namespace
}  // namespace splinecast
