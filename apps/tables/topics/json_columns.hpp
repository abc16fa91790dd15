#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "apps/messages/json_fields.hpp"
#include "apps/messages/json_path.hpp"
#include "apps/tables/options.hpp"
#include "apps/tables/topics/decoder.hpp"

namespace splinecast::apps {

/// Where the time of a JSON message is.
struct JsonTime {
  /// A number, an object with the members `sec` and `nsec` or `nanosec`, or a time of the message.
  enum class Kind : std::uint8_t { message, number, object };

  Kind kind = Kind::message;
  WhichTime which = WhichTime::log;   ///< of a time of the message
  TimeUnit unit = TimeUnit::seconds;  ///< of a number
  std::size_t field = 0;              ///< of a number; of an object, that of its seconds, and the
                                      ///< next one is that of its nanoseconds
  std::string name = "log time";      ///< for messages

  /// Throws MessageError if it is missing, not a time or out of range.
  [[nodiscard]] Time of(const TopicMessage& message, const JsonFields& fields) const;
};

/// The fields that are read from each message of a topic.
struct JsonColumns {
  RowColumns columns;
  std::vector<JsonPath> paths;  ///< of the columns, then of the time
  JsonTime time;
};

/// The fields by the options; without a choice, all numbers of the first message but those of its
/// time. Four numbers named `x y z w` or `w x y z` in an object `orientation`, `rotation` or `q`
/// are a quaternion. The time is that of `--time-column`; else the object `timestamp`,
/// `header.stamp` or `stamp` with the members `sec` and `nsec` or `nanosec`, if the first message
/// has one; else the log time. Throws InputError if a path is not valid or if there are more than
/// 64 columns or none, and MessageError if the message is not JSON.
[[nodiscard]] JsonColumns json_columns(std::string_view first, const TableOptions& options);

}  // namespace splinecast::apps
