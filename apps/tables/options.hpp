#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/files/numbers.hpp"
#include "apps/process/exit_codes.hpp"
#include "splinecast/dimension_kind.hpp"

namespace splinecast::apps {

/// A requested kind. The dimension is a name or an index from 0; of a quaternion, the first one.
struct KindOption {
  std::string dimension;
  Dimension kind{};
};

/// Which time of a message is the time of its row: the one in the message, or one of those that the
/// recorder added.
enum class WhichTime : std::uint8_t { header, log, publish };

/// Options for reading a file of rows.
struct TableOptions {
  std::vector<std::string> columns{};   ///< position columns, in this order; none: all numeric
  std::vector<KindOption> kinds{};      ///< of dimensions; others by the columns' names
  std::optional<TimeUnit> time_unit{};  ///< overrides the unit in the time column's name
  std::string time_column{};            ///< empty: the first column with the name of a time
  std::string topic{};                  ///< of a file with several; empty: the only usable one
  std::vector<std::string> fields{};    ///< positions in the messages of a topic, in this order
  std::vector<std::string> joints{};    ///< positions by the names of joints, in this order
  WhichTime which_time = WhichTime::header;
  bool only_times = false;  ///< rows have a time and no values
  bool quiet = false;       ///< no messages on stderr about columns
  /// Called with the number of each row that cannot be read; the row is left out. Unset: the first
  /// such row throws.
  std::function<void(std::size_t number, const InputError&)> on_bad_row{};
};

}  // namespace splinecast::apps
