#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace splinecast::apps {

/// A topic of a file.
struct TopicSummary {
  std::string name;      ///< `/joint_states`; of a ULog, `sensor_combined`, or `actuator:1`
  std::string type;      ///< of its messages
  std::string encoding;  ///< `cdr`, `json`; empty for a ULog
  std::uint64_t messages = 0;
  bool gives_rows = false;  ///< whether rows can be read from it
};

/// The topic that `wanted` names; if it is empty, the only one that gives rows. Of a recording of
/// this program, a stream's name is accepted for its topic `/NAME/waypoints`, and only topics of
/// waypoints are chosen without a name. Throws InputError, which lists the topics, if there is none
/// or more than one, and if the topic gives no rows.
[[nodiscard]] const TopicSummary& choose_topic(const std::string& file,
                                               const std::vector<TopicSummary>& topics,
                                               const std::string& wanted);

}  // namespace splinecast::apps
