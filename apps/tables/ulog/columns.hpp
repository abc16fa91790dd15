#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/messages/ulog_format.hpp"
#include "apps/tables/options.hpp"
#include "apps/tables/rows.hpp"
#include "splinecast/time.hpp"

namespace splinecast::apps {

/// The fields that are read from each sample of a topic of a ULog.
struct UlogColumns {
  RowColumns columns;
  std::vector<ulog::Field> fields;  ///< of the columns
  ulog::Field time;                 ///< an integer
  TimeUnit unit = TimeUnit::microseconds;
  std::size_t bytes = 0;  ///< of a sample that has all of these fields

  /// The time of a sample; nothing if it is out of range.
  [[nodiscard]] std::optional<Time> time_of(std::span<const std::byte> sample) const;
};

/// The fields by the options. A name chooses a field, or all elements of an array, or all fields of
/// a nested format. Without a choice all fields that are floating-point numbers are columns. Four
/// elements of an array `q` or `q_…` are a quaternion with w first. The time is the field
/// `timestamp`, or that of `--time-column`, in microseconds or in `--time-unit`. Throws InputError,
/// which begins with `where`, for an unknown field and for more than 64 columns or none.
[[nodiscard]] UlogColumns ulog_columns(const std::vector<ulog::Field>& fields,
                                       const std::string& where, const TableOptions& options);

}  // namespace splinecast::apps
