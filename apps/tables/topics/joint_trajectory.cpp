#include <fmt/format.h>

#include <optional>
#include <utility>

#include "apps/messages/message_error.hpp"
#include "apps/messages/ros.hpp"
#include "apps/tables/topics/decoder.hpp"
#include "apps/tables/topics/joints.hpp"

/// trajectory_msgs/msg/JointTrajectory: a row per point. A message replaces the future: the points
/// of the message before it that are not before its start give no rows. So its rows are known when
/// the next message is.
namespace splinecast::apps {
namespace {

/// The points of one message with its joints in the order of the columns.
struct Trajectory {
  struct Point {
    Time time{};
    std::vector<double> position{};
    std::vector<double> velocity{};
    std::vector<double> acceleration{};
  };
  std::uint64_t number = 0;
  std::vector<Point> points{};
  std::size_t size = 0;  ///< of the points in use; the others keep their memory
  std::size_t next = 0;  ///< the next point that is a row
};

class JointTrajectoryRows final : public MessageDecoder {
 public:
  JointTrajectoryRows(const ros::JointTrajectory& first, const TableOptions& options)
      : joints_(first.names, options), which_(options.which_time) {}

  [[nodiscard]] const RowColumns& columns() const override { return joints_.columns(); }
  [[nodiscard]] std::string time_name() const override {
    return name_of_time(which_, "header.stamp") + " + time_from_start";
  }

  void take(const TopicMessage& message) override {
    ros::decode(message.data, decoded_);
    if (!decoded_.points.empty()) joints_.match(decoded_.names);
    // A stamp of 0 means: begin when the message arrives.
    const Time stamp = decoded_.stamp == Time::zero() ? message.log_time : decoded_.stamp;
    const Time start = time_of(message, stamp, which_);
    for (const ros::TrajectoryPoint& point : decoded_.points) {
      if (point.positions.empty()) throw MessageError("a point has no positions");
    }
    std::swap(leaving_, newest_);
    end_ = start;
    newest_.number = message.number;
    newest_.size = decoded_.points.size();
    newest_.next = 0;
    if (newest_.points.size() < newest_.size) newest_.points.resize(newest_.size);
    for (std::size_t i = 0; i < newest_.size; ++i) {
      const ros::TrajectoryPoint& from = decoded_.points[i];
      Trajectory::Point& point = newest_.points[i];
      point.time = start + from.from_start;
      (void)joints_.ordered(from.positions, point.position);
      (void)joints_.ordered(from.velocities, point.velocity);
      (void)joints_.ordered(from.accelerations, point.acceleration);
    }
  }

  void finish() override {
    std::swap(leaving_, newest_);
    newest_.size = 0;
    end_.reset();
  }

  bool next(Row& row) override {
    while (leaving_.next < leaving_.size) {
      const Trajectory::Point& point = leaving_.points[leaving_.next++];
      if (end_ && point.time >= *end_) continue;
      row = {.number = leaving_.number,
             .time = point.time,
             .position = point.position,
             .velocity = point.velocity,
             .acceleration = point.acceleration};
      return true;
    }
    return false;
  }

  void rewind() override {
    leaving_.size = 0;
    newest_.size = 0;
  }

 private:
  JointNames joints_;
  WhichTime which_;
  ros::JointTrajectory decoded_;
  Trajectory newest_;
  Trajectory leaving_;       ///< the message before it
  std::optional<Time> end_;  ///< of `leaving_`: the start of `newest_`
};

}  // namespace

std::unique_ptr<MessageDecoder> open_joint_trajectory(const TopicBeginning& topic,
                                                      const TableOptions& options) {
  ros::JointTrajectory trajectory;
  ros::decode(topic.first.data, trajectory);
  return std::make_unique<JointTrajectoryRows>(trajectory, options);
}

}  // namespace splinecast::apps
