#pragma once

#include <cstddef>

#include "splinecast.h"
#include "splinecast/producer.hpp"

namespace splinecast::ipc {

[[nodiscard]] splinecast_limit_excess limit_excess_of(const LimitExcess& excess) noexcept;

/// A refusal or an excess of a C program, which may have changed it: checked. `name` is that of the
/// argument.
[[nodiscard]] LimitExcess read_excess(const splinecast_limit_excess& given, const char* name);
[[nodiscard]] ItemRefusal read_refusal(const splinecast_refusal& given);

/// Refusals on their way to a C program, which may have room for a part of them only.
class RefusalQueue {
 public:
  /// Calls `fetch` with the refusals to be overwritten if none are left, and writes as many as
  /// there is room for. Returns their number. Fetches nothing if it throws BadArgument.
  template <typename Fetch>
  int deliver(splinecast_refusals* out, const Fetch& fetch) {
    require_room(out);
    if (next_ == found_.items.size()) {
      fetch(found_);
      next_ = 0;
    }
    return write(out);
  }

 private:
  static void require_room(const splinecast_refusals* out);
  int write(splinecast_refusals* out);

  Refusals found_;
  std::size_t next_ = 0;  ///< the first that has not been written
};

}  // namespace splinecast::ipc
