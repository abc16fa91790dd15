#include "apps/replay/solver_wait.hpp"

#include <fmt/format.h>

#include <chrono>

#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "ipc/law/follower.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/owned/old_motion.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"

namespace splinecast::apps {
namespace {

/// Whether a solver has begun a time law.
bool has_begun(const std::string& law, const Trust& trust) {
  try {
    ipc::LawPoint point;
    return has_values(ipc::LawFollower(law, trust).at(MonotonicClock().now(), point));
  } catch (const NoSuchStream&) {
    return false;
  }
}

}  // namespace

void throw_no_solver(const ReplayOptions& options) {
  if (ipc::region_exists(options.stream, ipc::RegionKind::spline)) {
    (void)ipc::open_board(options.stream, false, options.ring.trust);
  }
  throw TimeOut(fmt::format("no solver for stream '{}' within {} s: run 'splinecast solve {}'",
                            options.stream, to_seconds(options.wait), options.stream));
}

bool await_solver_of_finished(const ReplayOptions& options) {
  if (!ipc::region_exists(options.stream, ipc::RegionKind::spline)) return true;
  const MonotonicClock clock;
  const Time end = deadline(clock, options.wait);
  while (!ipc::is_owned(options.stream, ipc::RegionKind::spline)) {
    if (clock.now() >= end) throw_no_solver(options);
    if (!sleep_until(clock.now() + std::chrono::milliseconds(2))) return false;
  }
  return true;
}

bool await_law(const ReplayOptions& options) {
  if (options.ring.law.empty()) return true;
  ipc::require_stream_name(options.ring.law);
  const MonotonicClock clock;
  const Time end = deadline(clock, options.wait);
  while (!has_begun(options.ring.law, options.ring.trust)) {
    if (clock.now() >= end) {
      throw TimeOut(
          fmt::format("time law '{0}' has not begun within {1} s: run 'splinecast solve "
                      "{0}' and 'splinecast rate {0} 1'",
                      options.ring.law, to_seconds(options.wait)));
    }
    if (!sleep_until(clock.now() + std::chrono::milliseconds(2))) return false;
  }
  return true;
}

Time rest_of_old_motion(const ReplayOptions& options, std::uint64_t stream_id) {
  const Time end = ipc::end_of_old_motion(options.stream, stream_id, options.ring.trust);
  const Time now = MonotonicClock().now();
  ipc::require_near_end(options.stream, end, now);
  if (end <= now) return Time::zero();
  if (!options.quiet) {
    say(fmt::format("'{}': waiting {:.1f} s for the end of the previous motion", options.stream,
                    to_seconds(end - now)));
  }
  return end - now;
}

}  // namespace splinecast::apps
