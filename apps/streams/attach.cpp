#include "apps/streams/attach.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "apps/process/exit_codes.hpp"
#include "apps/process/signals.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::apps {

Reader attach_reader(const std::string& stream, Time wait, const Trust& trust) {
  constexpr Time kSlice = std::chrono::milliseconds(50);  // so that a stop ends the wait
  const MonotonicClock clock;
  const Time end = deadline(clock, wait);
  for (;;) {
    const Time left = std::max(end - clock.now(), Time::zero());
    try {
      return Reader(stream, std::min(kSlice, left), trust);
    } catch (const LawLost&) {
      throw;
    } catch (const NoSuchStream&) {
      if (stop_requested()) {
        throw Interrupted(fmt::format("interrupted before stream '{}' existed", stream));
      }
      if (clock.now() >= end) throw;
    }
  }
}

}  // namespace splinecast::apps
