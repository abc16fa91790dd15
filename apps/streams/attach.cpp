#include "apps/streams/attach.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "apps/process/exit_codes.hpp"
#include "apps/process/signals.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::apps {

ipc::Reader attach_reader(const std::string& stream, core::Time wait, const ipc::Trust& trust) {
  constexpr core::Time kSlice = std::chrono::milliseconds(50);  // so that a stop ends the wait
  const ipc::MonotonicClock clock;
  const core::Time end = ipc::deadline(clock, wait);
  for (;;) {
    const core::Time left = std::max(end - clock.now(), core::Time::zero());
    try {
      return ipc::Reader(stream, std::min(kSlice, left), trust);
    } catch (const ipc::NoSuchStream&) {
      if (stop_requested()) {
        throw Interrupted(fmt::format("interrupted before stream '{}' was there", stream));
      }
      if (clock.now() >= end) throw;
    }
  }
}

}  // namespace splinecast::apps
