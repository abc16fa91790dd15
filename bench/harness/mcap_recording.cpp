#include "bench/harness/mcap_recording.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <vector>

#include "bench/harness/bench_stream.hpp"
#include "tests/fixtures/messages/cdr_writer.hpp"
#include "tests/fixtures/messages/mcap_file.hpp"

namespace splinecast::bench {
namespace {

constexpr std::size_t kDimensions = 7;

std::vector<std::string> joint_names() {
  std::vector<std::string> names;
  for (std::size_t d = 1; d <= kDimensions; ++d) names.push_back(fmt::format("joint_{}", d));
  return names;
}

/// `"joint_1":0.5,"joint_2":…`
std::string members(const std::vector<std::string>& names, std::span<const double> values) {
  std::string text;
  for (std::size_t d = 0; d < names.size(); ++d) {
    text += fmt::format("{}\"{}\":{}", d == 0 ? "" : ",", names[d], values[d]);
  }
  return text;
}

void write_joint_states(testing::McapFile& file) {
  const auto topic = file.channel("/joint_states", "sensor_msgs/msg/JointState");
  const std::vector<std::string> names = joint_names();
  Feed feed(kDimensions);
  for (std::size_t i = 0; i < McapRecording::kRows; ++i) {
    const Waypoint waypoint = feed.next();
    const std::vector<double> position(waypoint.position.begin(), waypoint.position.end());
    file.write(topic, waypoint.time, testing::joint_state(waypoint.time, names, position, {}));
  }
}

void write_recorded_stream(testing::McapFile& file) {
  const std::vector<std::string> names = joint_names();
  const std::string schema =
      fmt::format(R"({{"properties":{{"position":{{"properties":{{{}}}}}}}}})",
                  members(names, std::vector<double>(kDimensions)));
  const auto topic = file.channel("/arm/waypoints", "splinecast.Waypoint", "json", schema);
  Feed feed(kDimensions);
  for (std::size_t i = 0; i < McapRecording::kRows; ++i) {
    const Waypoint waypoint = feed.next();
    file.write(topic, waypoint.time,
               fmt::format(R"({{"time_ns":{},"kind":"waypoint","item":{},"position":{{{}}}}})",
                           waypoint.time.count(), i + 1, members(names, waypoint.position)));
  }
}

}  // namespace

McapRecording::McapRecording(Kind kind)
    : path_(std::filesystem::temp_directory_path() /
            fmt::format("splinecast_bench.{}.{}.mcap", getpid(), static_cast<int>(kind))) {
  testing::McapFile file(path_);
  if (kind == Kind::joint_states) {
    write_joint_states(file);
  } else {
    write_recorded_stream(file);
  }
  file.finish();
}

}  // namespace splinecast::bench
