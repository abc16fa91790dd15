#include "apps/messages/message_error.hpp"
#include "apps/messages/ros.hpp"
#include "apps/tables/topics/decoder.hpp"
#include "apps/tables/topics/joints.hpp"

/// sensor_msgs/msg/JointState: a row per message.
namespace splinecast::apps {
namespace {

class JointStateRows final : public SingleRowDecoder {
 public:
  JointStateRows(const ros::JointState& first, const TableOptions& options)
      : joints_(first.names, options), which_(options.which_time) {}

  [[nodiscard]] const RowColumns& columns() const override { return joints_.columns(); }
  [[nodiscard]] std::string time_name() const override {
    return name_of_time(which_, "header.stamp");
  }

 private:
  Row decode(const TopicMessage& message) override {
    ros::decode(message.data, state_);
    joints_.match(state_.names);
    if (state_.positions.empty()) throw MessageError("it has no positions");
    return {.number = message.number,
            .time = time_of(message, state_.stamp, which_),
            .position = joints_.ordered(state_.positions, position_),
            .velocity = joints_.ordered(state_.velocities, velocity_)};
  }

  JointNames joints_;
  WhichTime which_;
  ros::JointState state_;
  std::vector<double> position_;
  std::vector<double> velocity_;
};

}  // namespace

std::unique_ptr<MessageDecoder> open_joint_state(const TopicBeginning& topic,
                                                 const TableOptions& options) {
  ros::JointState state;
  ros::decode(topic.first.data, state);
  return std::make_unique<JointStateRows>(state, options);
}

}  // namespace splinecast::apps
