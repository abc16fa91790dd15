#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "apps/cli/guarded.hpp"
#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/streams/holders.hpp"
#include "ipc/law/effect.hpp"
#include "ipc/mapping/checked_region.hpp"
#include "ipc/mapping/owner_lock.hpp"
#include "ipc/owned/old_motion.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/streams.hpp"

namespace splinecast::apps {
namespace {

/// Waits while a motion whose writers have ended continues to its stop, because readers follow it.
/// A motion that would end after more than an hour is removed at once. Returns false after a
/// signal.
bool wait_for_rest(const std::string& stream, const Trust& trust) {
  for (const auto kind : {ipc::RegionKind::waypoints, ipc::RegionKind::spline}) {
    if (ipc::is_owned(stream, kind)) return true;  // remove_stream() refuses it
  }
  const Time end = ipc::end_of_motion(stream, trust);
  const Time now = MonotonicClock().now();
  if (end <= now || end - now > ipc::kLongestOldMotion) return true;
  say(fmt::format("'{}': waiting {:.1f} s for the end of its motion", stream,
                  to_seconds(end - now)));
  return sleep_until(end);
}

/// Throws StreamBusy if other streams follow the stream, a time law: no process could attach to
/// them any more.
void require_without_followers(const std::string& stream, const Trust& trust) {
  std::vector<std::string> followers;
  try {
    const auto header = ipc::peek_header(stream, ipc::RegionKind::spline, trust);
    if (header && header->is_law != 0) followers = ipc::followers_of(header->stream_id, trust);
  } catch (const StreamError&) {
    return;  // remove_stream() judges the file
  }
  if (followers.empty()) return;
  throw StreamBusy(fmt::format(
      "time law '{}' is followed by '{}': remove that first; --now removes the law all the same",
      stream, fmt::join(followers, "', '")));
}

/// Reports the stops that remain in force for a stream of this name.
void report_holders(const std::string& stream, const Trust& trust) {
  const Holders holders = holders_by_stream(trust);
  const auto own = holders.find(stream);
  if (own == holders.end()) return;
  say(
      fmt::format("'{0}': a stream of this name will be stopped by {1}: `splinecast stop {0} "
                  "--release --as NAME` withdraws that",
                  stream, quoted(own->second)));
}

void add_rm(Command& verb, Action& action) {
  struct Options {
    std::vector<std::string> streams;
    Trust trust;
    bool now = false;
  };
  auto options = std::make_shared<Options>();
  verb.option("STREAM", options->streams, "Names of the streams to remove").required();
  verb.flag("--now", options->now,
            "Do not wait for the end of a motion: readers lose the curve while it moves; also "
            "remove a time law that streams follow");
  add_trust(verb, options->trust);
  verb.callback([&action, options] {
    action = [options] {
      int code = kOk;
      for (const std::string& stream : options->streams) {
        // Continues after a failure.
        code = std::max(code, run_guarded([&] {
                          if (!options->now) {
                            require_without_followers(stream, options->trust);
                            if (!wait_for_rest(stream, options->trust)) return kInterrupted;
                          }
                          remove_stream(stream, options->trust);
                          report_holders(stream, options->trust);
                          return kOk;
                        }));
      }
      return code;
    };
  });
}

const Verb rm_verb("rm", 120, "Remove streams whose writers have ended", add_rm);

}  // namespace

}  // namespace splinecast::apps
