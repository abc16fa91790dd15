#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "apps/messages/ros.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/tables/topics/decoder.hpp"

/// geometry_msgs/msg/PoseStamped and nav_msgs/msg/Odometry: a row per message.
namespace splinecast::apps {
namespace {

constexpr std::array<std::string_view, 7> kNames{"x", "y", "z", "qx", "qy", "qz", "qw"};

using DecodePose = void (*)(ros::Bytes message, ros::Pose& pose);

class PoseRows final : public SingleRowDecoder {
 public:
  PoseRows(DecodePose decode_pose, const TableOptions& options)
      : decode_pose_(decode_pose), which_(options.which_time) {
    columns_.names = chosen_names(options);
    if (columns_.names.empty()) columns_.names.assign(kNames.begin(), kNames.end());
    for (const std::string& name : columns_.names) {
      const auto* const found = std::ranges::find(kNames, name);
      if (found == kNames.end()) {
        throw InputError(
            fmt::format("there is no column '{}' among {}", shown(name), fmt::join(kNames, ", ")));
      }
      at_.push_back(static_cast<std::size_t>(found - kNames.begin()));
    }
    position_.resize(at_.size());
  }

  [[nodiscard]] const RowColumns& columns() const override { return columns_; }
  [[nodiscard]] std::string time_name() const override {
    return name_of_time(which_, "header.stamp");
  }

 private:
  Row decode(const TopicMessage& message) override {
    decode_pose_(message.data, pose_);
    for (std::size_t i = 0; i < at_.size(); ++i) position_[i] = pose_.values[at_[i]];
    return {.number = message.number,
            .time = time_of(message, pose_.stamp, which_),
            .position = position_};
  }

  DecodePose decode_pose_;
  WhichTime which_;
  RowColumns columns_;
  std::vector<std::size_t> at_;  ///< of each column, its index in a pose
  ros::Pose pose_;
  std::vector<double> position_;
};

}  // namespace

std::unique_ptr<MessageDecoder> open_pose_stamped(const TopicBeginning& /*topic*/,
                                                  const TableOptions& options) {
  return std::make_unique<PoseRows>(ros::decode_pose_stamped, options);
}

std::unique_ptr<MessageDecoder> open_odometry(const TopicBeginning& /*topic*/,
                                              const TableOptions& options) {
  return std::make_unique<PoseRows>(ros::decode_odometry, options);
}

}  // namespace splinecast::apps
