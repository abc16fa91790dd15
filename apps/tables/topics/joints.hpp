#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/tables/options.hpp"
#include "apps/tables/rows.hpp"

namespace splinecast::apps {

/// Matches the joints of messages by name. Messages may have them in another order each, and may
/// have more of them.
class JointNames {
 public:
  /// The joints that the options choose, else those of the first message. Throws InputError for a
  /// chosen joint that the first message does not have, and for more than 64 joints.
  JointNames(const std::vector<std::string_view>& first, const TableOptions& options);

  [[nodiscard]] const RowColumns& columns() const noexcept { return columns_; }
  [[nodiscard]] std::size_t size() const noexcept { return columns_.names.size(); }

  /// Finds the joints of the next message. Throws MessageError with the name of a joint that is
  /// missing.
  void match(const std::vector<std::string_view>& names);

  /// Copies the values of a message in the order of the columns. `from` has one for each of its
  /// joints, or none, in which case the result is empty.
  std::span<const double> ordered(std::span<const double> from, std::vector<double>& values) const;

 private:
  RowColumns columns_;
  std::vector<std::string> matched_;  ///< names of the message that was matched last
  std::vector<std::size_t> at_;       ///< of each column, its index in that message
};

}  // namespace splinecast::apps
