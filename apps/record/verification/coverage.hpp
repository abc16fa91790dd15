#pragma once

#include <vector>

#include "apps/record/format/loss.hpp"

namespace splinecast::apps::record {

/// Which numbers a file has something about. Takes little memory if they come in order.
class Coverage {
 public:
  void add(const NumberSpan& range);

  /// The number after the last one that is covered.
  [[nodiscard]] ipc::Word end() const noexcept { return end_; }

  /// How many numbers from `first` up to `end` are not covered. O(n log n).
  [[nodiscard]] ipc::Word missing(ipc::Word first, ipc::Word end) const;

 private:
  std::vector<NumberSpan> ranges_;
  ipc::Word end_ = 0;
};

}  // namespace splinecast::apps::record
