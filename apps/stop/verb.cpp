#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/streams/holders.hpp"
#include "apps/streams/report.hpp"
#include "ipc/board/named_board.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/owned/old_motion.hpp"
#include "ipc/owned/stoppers.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/stopper.hpp"
#include "splinecast/streams.hpp"

/// `stop`: stops live streams, or releases them.
namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

struct StopOptions {
  std::string wanted;  ///< a stream's name, or a pattern
  std::string stopper;
  bool release = false;
  Time wait = std::chrono::seconds(1);  ///< until the requests are in force
  bool json = false;
  Trust trust;
};

/// Why a stream has no stoppers; empty if it has.
std::string why_not(const std::string& stream, const Trust& trust) {
  for (const auto kind : {ipc::RegionKind::waypoints, ipc::RegionKind::spline}) {
    try {
      const auto header = ipc::peek_header(stream, kind, trust);
      if (!header) continue;
      if (header->is_law != 0) {
        return fmt::format("'{0}' is a time law: `splinecast rate {0} 0` holds it", stream);
      }
      if (static_cast<StreamClock>(header->clock) == StreamClock::recorded) {
        return fmt::format("'{}' is a recorded stream: no machine follows it", stream);
      }
      return {};
    } catch (const StreamError&) {
      continue;  // a file that cannot be read must not keep a stream from being stopped
    }
  }
  return {};
}

bool exists(const std::string& stream) {
  return ipc::region_exists(stream, ipc::RegionKind::waypoints) ||
         ipc::region_exists(stream, ipc::RegionKind::spline);
}

/// A request to one stream.
class StreamRequest {
 public:
  StreamRequest(std::string stream, const StopOptions& options)
      : stream_(std::move(stream)), stopper_(options.stopper), is_release_(options.release) {}

  /// Makes the request. Returns false if another process that lives has the stopper's name. If that
  /// lasts, `is_last`, a stop is requested under a name of this process.
  bool make(const Trust& trust, bool is_last) {
    try {
      request(trust);
      return true;
    } catch (const StreamBusy&) {
      if (!is_last) return false;
    }
    if (is_release_) {
      throw StreamBusy(
          fmt::format("'{}': the stopper '{}' is a process that lives: only that can "
                      "release the stream",
                      stream_, stopper_));
    }
    const std::string own = fmt::format("{}.{}", stopper_, getpid());
    say(fmt::format("'{}': the stopper '{}' is a process that lives; requested as '{}'", stream_,
                    stopper_, own));
    stopper_ = own;
    request(trust);
    return true;
  }

  [[nodiscard]] const std::string& stream() const { return stream_; }

  /// Looks whether the request is in force.
  void look() {
    is_in_force_ = is_in_force_ || (role_ && role_->wait_in_force(number_, Time::zero()));
  }
  [[nodiscard]] bool is_made() const { return role_.has_value(); }
  /// Whether there is nothing to wait for: no process can put a release in force without a stream.
  [[nodiscard]] bool is_done() const { return is_in_force_ || (is_release_ && !exists(stream_)); }

  /// Whether a stop is in force, but not on a motion that was finished before and still lasts.
  [[nodiscard]] bool has_succeeded(const Trust& trust) {
    if (!is_in_force_) return is_release_ && !exists(stream_);
    return is_release_ || !is_finished(trust) || rest(trust) <= Time::zero();
  }

  [[nodiscard]] std::string in_words(const StopOptions& options) {
    if (is_release_) return release_in_words(options);
    const std::string request = fmt::format("'{}': the stop of '{}'", stream_, stopper_);
    const double seconds = std::max(to_seconds(rest(options.trust)), 0.0);
    if (!is_in_force_) return request + not_in_force(options);
    if (!has_succeeded(options.trust)) {
      return fmt::format(
          "{} came after its finish: the last motion cannot be stopped, and ends in "
          "{:.3f} s",
          request, seconds);
    }
    return seconds > 0 ? fmt::format("{} is in force: at rest in {:.3f} s", request, seconds)
                       : fmt::format("{} is in force: at rest", request);
  }

  [[nodiscard]] ordered_json to_json(const Trust& trust) {
    return {{"stream", stream_},
            {"stopper", stopper_},
            {"request", number_},
            {"latched", !is_release_},
            {"in_force", is_in_force_},
            {"holders", holders(trust)},
            {"rest_in_s", std::max(to_seconds(rest(trust)), 0.0)}};
  }

 private:
  void request(const Trust& trust) {
    role_.emplace(stream_, stopper_, RegionAccess{}, trust);
    number_ = is_release_ ? role_->release() : role_->stop();
  }

  /// The time from now until the published curve is at rest.
  [[nodiscard]] Time rest(const Trust& trust) const {
    const Time end = ipc::end_of_motion(stream_, trust);
    return std::max(end, MonotonicClock().now()) - MonotonicClock().now();
  }

  [[nodiscard]] bool is_finished(const Trust& trust) const {
    ipc::NamedBoard board(stream_, trust);
    ipc::Summary summary;
    return board.is_there() && board.reader().copy_newest_summary(summary) && summary.finished;
  }

  /// Who holds the stream by its board; without one, who requests it.
  [[nodiscard]] std::vector<std::string> holders(const Trust& trust) const {
    ipc::NamedBoard board(stream_, trust);
    if (is_in_force_ && board.is_there()) return ipc::holders_of(board.reader());
    const Holders requested = holders_by_stream(trust);
    const auto own = requested.find(stream_);
    return own != requested.end() ? own->second : std::vector<std::string>{};
  }

  [[nodiscard]] std::string not_in_force(const StopOptions& options) const {
    const std::string why = exists(stream_) ? "no solver has heard it" : "no stream of this name";
    return fmt::format(" is not in force after {:g} s: {}; the request remains",
                       to_seconds(options.wait), why);
  }

  [[nodiscard]] std::string release_in_words(const StopOptions& options) const {
    std::string text = fmt::format("'{}': released by '{}'", stream_, stopper_);
    if (!exists(stream_)) {
      text += "; no stream of this name";
    } else if (!is_in_force_) {
      text = fmt::format("'{}': the release by '{}'{}", stream_, stopper_, not_in_force(options));
    }
    const auto left = holders(options.trust);
    return left.empty() ? text : text + "; still held by " + quoted(left);
  }

  std::string stream_;
  std::string stopper_;
  bool is_release_;
  std::optional<Stopper> role_;
  std::uint64_t number_ = 0;
  bool is_in_force_ = false;
};

/// The streams that are meant. A pattern means those that exist now and, for a release, those that
/// a stopper holds. Streams without stoppers are left out of a pattern, and reported.
std::vector<std::string> streams_of(const StopOptions& options) {
  if (!ipc::is_pattern(options.wanted)) {
    ipc::require_stream_name(options.wanted);
    const std::string why = why_not(options.wanted, options.trust);
    if (!why.empty()) throw BadRequest(why);
    return {options.wanted};
  }
  std::set<std::string> found;
  for (const std::string& stream : stream_names()) found.insert(stream);
  if (options.release) {
    for (const auto& [stream, names] : holders_by_stream(options.trust)) found.insert(stream);
  }
  std::erase_if(found, [&](const std::string& stream) {
    if (!ipc::matches(options.wanted, stream)) return true;
    const std::string why = why_not(stream, options.trust);
    if (!why.empty()) say(why + "; left out");
    return !why.empty();
  });
  if (found.empty()) throw NoSuchStream("no stream matches '" + options.wanted + "'");
  return {found.begin(), found.end()};
}

/// Waits until all requests are in force, until `end`, or until a signal.
void await(std::vector<StreamRequest>& requests, Time end) {
  for (;;) {
    for (StreamRequest& request : requests) request.look();
    const bool is_done = std::ranges::all_of(requests, &StreamRequest::is_done);
    if (is_done || MonotonicClock().now() >= end) return;
    if (!sleep_until(MonotonicClock().now() + std::chrono::milliseconds(1))) return;
  }
}

/// Makes all requests: no stream waits for another one. Those that cannot be made are reported, and
/// removed. Returns whether there are none.
bool make_all(std::vector<StreamRequest>& requests, const Trust& trust) {
  constexpr Time kLongestBusy = std::chrono::milliseconds(100);
  const Time last = MonotonicClock().now() + kLongestBusy;
  const std::size_t wanted = requests.size();
  for (bool is_done = false; !is_done;) {
    const bool is_last = MonotonicClock().now() >= last;
    is_done = true;
    std::erase_if(requests, [&](StreamRequest& request) {
      try {
        is_done = (request.is_made() || request.make(trust, is_last)) && is_done;
        return false;
      } catch (const StreamError& error) {
        say(error.what());
        return true;
      }
    });
    if (!is_done && !sleep_until(MonotonicClock().now() + std::chrono::milliseconds(2))) break;
  }
  return requests.size() == wanted;
}

int run_stop(const StopOptions& options) {
  const Time end = MonotonicClock().now() + options.wait;
  std::vector<StreamRequest> requests;
  for (const std::string& stream : streams_of(options)) requests.emplace_back(stream, options);
  int code = make_all(requests, options.trust) ? kOk : kNoStreamOrTimeOut;
  await(requests, end);
  ordered_json list = ordered_json::array();
  for (StreamRequest& request : requests) {
    const bool has_succeeded = request.has_succeeded(options.trust);
    if (!has_succeeded) code = kNoStreamOrTimeOut;
    if (options.json) list.push_back(request.to_json(options.trust));
    if (!options.json || !has_succeeded) {
      has_succeeded ? print_report(request.in_words(options) + "\n")
                    : say(request.in_words(options));
    }
  }
  if (options.json) print_report(pretty(list));
  return code;
}

/// The name of this process's user, if it can name a stopper.
std::string user_name() {
  const passwd* const user = getpwuid(geteuid());
  const std::string name = user != nullptr ? user->pw_name : "";
  return ipc::is_stream_name(name) ? name : fmt::format("user{}", geteuid());
}

void add_stop(Command& verb, Action& action) {
  auto options = std::make_shared<StopOptions>();
  options->stopper = user_name();
  verb.option("STREAM", options->wanted,
              "Stream, or a pattern of those that exist now: * ? and [...] as in a shell")
      .required();
  verb.flag("--release", options->release, "Withdraw the stopper's request");
  verb.option("--as", options->stopper, "Name of the stopper (default: the user's name)")
      .type("STOPPER");
  add_seconds(verb, "--wait", options->wait,
              "Wait until the solvers have put the requests in force, for this time in s, 0 to "
              "3600 (default 1)",
              {Time::zero(), std::chrono::hours(1)});
  verb.flag("--json", options->json, "Print JSON");
  add_trust(verb, options->trust);
  verb.callback([&action, options] {
    action = [options] {
      ipc::require_stream_name(options->stopper);
      catch_stop_signals();
      return run_stop(*options);
    };
  });
}

const Verb stop_verb("stop", 96, "Stop live streams, until the stop is released", add_stop);

}  // namespace
}  // namespace splinecast::apps
