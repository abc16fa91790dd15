#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/rate/report.hpp"
#include "apps/streams/report.hpp"
#include "core/laws/rate_plan.hpp"
#include "ipc/law/follower.hpp"
#include "ipc/mapping/region.hpp"
#include "ipc/memory/names.hpp"
#include "ipc/options/curve.hpp"
#include "ipc/options/stream.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/rate_commander.hpp"

/// `rate`: shows or changes the rate of a time law.
namespace splinecast::apps {
namespace {

/// Published motion that is looked at for the effect of a ramp.
constexpr Time kLooksAhead = std::chrono::seconds(10);
/// How often a wait looks for a signal.
constexpr Time kSignals = std::chrono::milliseconds(50);
constexpr TimeRange kRamps{ipc::kShortestRamp, ipc::kLongestRamp};

struct RateOptions {
  std::string law;
  std::optional<double> rate;
  Time ramp = std::chrono::milliseconds(500);
  std::optional<Time> gentle;  ///< the ramp may be lengthened to this
  std::string commander = "operator";
  bool release = false;
  bool force = false;
  std::optional<Time> dead_man;
  Time dead_man_ramp = ipc::kDeadManRamp;
  Time wait = std::chrono::seconds(1);  ///< until the request is in force
  bool json = false;
  Trust trust;

  /// Whether this is the commander of that name.
  [[nodiscard]] bool is_own(const ipc::CommanderState& state) const {
    return state.name == commander;
  }
};

/// Throws BadRequest if another stream than a law has the name: says how to get a law.
void require_law(const RateOptions& options) {
  std::optional<ipc::RegionHeader> header;
  try {
    header = ipc::peek_header(options.law, ipc::RegionKind::waypoints, options.trust);
  } catch (const StreamError&) {
    return;  // there is none yet, or it is not this user's: what follows reports it
  }
  if (!header || header->is_law != 0) return;
  if (header->law_id != 0) {
    throw BadRequest(fmt::format("'{0}' is not a time law, but follows one: `splinecast rate {1}`",
                                 options.law, ipc::text_of(header->law)));
  }
  throw BadRequest(fmt::format(
      "'{0}' is a stream without a time law. Its producer names one when it creates the "
      "stream: `splinecast replay FILE --stream {0} --law {0}.law`, or "
      "ProducerOptions::law; `splinecast solve {0} {0}.law` solves both. "
      "`splinecast stop {0}` stops it without a law",
      options.law));
}

/// The law as published, if a solver has begun it.
std::unique_ptr<ipc::LawFollower> open_law(const RateOptions& options) {
  try {
    auto law = std::make_unique<ipc::LawFollower>(options.law, options.trust);
    ipc::LawPoint point;
    return has_values(law->at(MonotonicClock().now(), point)) ? std::move(law) : nullptr;
  } catch (const NoSuchStream&) {
    return nullptr;
  }
}

std::vector<ipc::CommanderState> commanders_of(const RateOptions& options) {
  ipc::RegionWatch watch;
  watch.poll();
  ipc::Commanders commanders(options.law, options.trust, watch);
  commanders.poll();
  commanders.read(MonotonicClock().now());
  return commanders.states();
}

int show(const RateOptions& options) {
  LawReport state;
  state.law = options.law;
  state.commanders = commanders_of(options);
  const auto law = open_law(options);
  if (law) {
    const ipc::LawPoint& point = law->last();
    state.is_solved = true;
    state.rate = point.rates.rate;
    state.slope = point.rates.slope;
    state.lag = law->last_host() - point.stream;
    state.max_rate = law->max_rate();
    state.followers = ipc::followers_of(law->header().stream_id, options.trust);
  } else if (state.commanders.empty()) {
    throw NoSuchStream("there is no time law '" + options.law + "'");
  }
  print_report(options.json ? pretty(to_json(state)) : in_words(state));
  return kOk;
}

/// The rate that the law will have with the requested change.
double rate_after(const RateOptions& options, double largest) {
  auto states = commanders_of(options);
  std::erase_if(states, [&](const auto& state) { return options.is_own(state); });
  if (!options.release) {
    states.push_back({.name = options.commander, .command = {.rate = *options.rate}});
  }
  return ipc::least_rate(states, largest);
}

/// A law, and its state where a ramp that is requested now begins.
struct Present {
  std::unique_ptr<ipc::LawFollower> law;
  core::LawState from;
};

/// Returns nothing if no solver has begun the law.
std::optional<Present> present_law(const RateOptions& options) {
  auto law = open_law(options);
  if (!law) return std::nullopt;
  const auto from =
      law->state_at(MonotonicClock().now() + 2 * ipc::live_options(law->header())->settle_ahead);
  return from ? std::optional<Present>({std::move(law), *from}) : std::nullopt;
}

/// The effects of a ramp of this length on streams that follow the law. A stream that cannot be
/// read is reported, and removed from `streams`.
std::vector<ipc::RampEffect> effects_of(const Present& present, std::vector<std::string>& streams,
                                        double rate, Time length, const Trust& trust) {
  std::vector<ipc::RampEffect> effects;
  const core::LawState& from = present.from;
  const core::RateCurve ramp = core::ramp_alone(from.time, {.rate = from.rate, .slope = from.slope},
                                                {.rate = rate, .ramp = length});
  const Time origin(present.law->header().law_origin);
  std::erase_if(streams, [&](const std::string& stream) {
    try {
      effects.push_back(ipc::effect_of(stream, from, ramp, origin, length + kLooksAhead, trust));
      return false;
    } catch (const StreamError& error) {
      say(fmt::format("'{}': the effect on it is not known: {}", stream, error.what()));
      return true;
    }
  });
  return effects;
}

/// The first effect beyond a limit of its stream.
const ipc::RampEffect* beyond_limits(const std::vector<ipc::RampEffect>& effects) {
  constexpr double kRounding = 1e-9;
  const auto found = std::ranges::find_if(
      effects, [](const ipc::RampEffect& effect) { return effect.worst.ratio > 1 + kRounding; });
  return found == effects.end() ? nullptr : &*found;
}

/// The shortest ramp, to about 10 %, that keeps the limits; nothing if none up to `longest` does,
/// or if `deadline` comes first.
std::optional<Time> sufficient_ramp(const Present& present, std::vector<std::string>& streams,
                                    double rate, Time shorter, const Trust& trust,
                                    Time longest = std::chrono::minutes(1),
                                    Time deadline = Time::max()) {
  constexpr double kGrowth = 1.1;
  for (double seconds = to_seconds(shorter); seconds < to_seconds(longest); seconds *= kGrowth) {
    if (MonotonicClock().now() >= deadline) return std::nullopt;
    const Time length = std::min(from_seconds(kGrowth * seconds), longest);
    if (beyond_limits(effects_of(present, streams, rate, length, trust)) == nullptr) return length;
  }
  return std::nullopt;
}

/// Reports the effect of a ramp that is to be requested, or has been. Returns false if it exceeds a
/// limit and is not forced.
bool report_effect(const RateOptions& options, const Present& present, bool is_requested) {
  const double rate = rate_after(options, present.law->max_rate());
  auto streams = ipc::followers_of(present.law->header().stream_id, options.trust);
  const auto effects = effects_of(present, streams, rate, options.ramp, options.trust);
  if (options.json) {
    nlohmann::ordered_json json{{"law", options.law}, {"rate", rate}};
    json["effects"] = nlohmann::ordered_json::array();
    for (const ipc::RampEffect& effect : effects) json["effects"].push_back(to_json(effect));
    print_report(pretty(json));
  } else {
    std::string text =
        fmt::format("'{}': rate {:g} in {:g} s\n", options.law, rate, to_seconds(options.ramp));
    for (const ipc::RampEffect& effect : effects) text += in_words(effect);
    print_report(text);
  }
  const ipc::RampEffect* const beyond = beyond_limits(effects);
  if (beyond == nullptr || options.force) return true;
  const auto enough = sufficient_ramp(present, streams, rate, options.ramp, options.trust);
  say(fmt::format("{}: {}; {}{}", is_requested ? "requested" : "refused", excess_in_words(*beyond),
                  enough ? fmt::format("a ramp of {:.3g} s would do", to_seconds(*enough))
                         : "no ramp up to a minute would do",
                  is_requested ? "" : "; --force requests it all the same"));
  return false;
}

/// The ramp, or a longer one if the limits of a stream need it: the longest that may be taken, if
/// no shorter one has been found soon.
Time gentle_ramp(const RateOptions& options, const Present& present) {
  constexpr Time kMostDelay = std::chrono::milliseconds(20);
  const Time end = MonotonicClock().now() + kMostDelay;
  const double rate = rate_after(options, present.law->max_rate());
  auto streams = ipc::followers_of(present.law->header().stream_id, options.trust);
  if (!beyond_limits(effects_of(present, streams, rate, options.ramp, options.trust))) {
    return options.ramp;
  }
  return sufficient_ramp(present, streams, rate, options.ramp, options.trust, *options.gentle, end)
      .value_or(*options.gentle);
}

/// Renews a request until a stop is requested, so that the law holds if this process dies. Returns
/// the exit code.
int keep_alive(const RateOptions& options, RateCommander& commander) {
  while (sleep_until(MonotonicClock().now() + *options.dead_man / 4)) {
    if (commander.renew()) continue;
    say(
        fmt::format("'{}': the dead man of '{}' has fired: the law holds until '{}' makes another "
                    "request",
                    options.law, options.commander, options.commander));
    return kFailed;
  }
  return kOk;
}

/// Returns the number of the request.
std::uint64_t request(const RateOptions& options, RateCommander& commander) {
  commander.set_dead_man(options.dead_man.value_or(Time::zero()), options.dead_man_ramp);
  return options.release ? commander.release(options.ramp)
                         : commander.set_rate(*options.rate, options.ramp);
}

/// Waits until a request is in force, and renews it meanwhile. Returns whether it is.
bool wait_in_force(const RateOptions& options, RateCommander& commander, std::uint64_t number) {
  if (options.wait == Time::zero()) return true;
  const Time slice = options.dead_man ? *options.dead_man / 4 : options.wait;
  const Time end = MonotonicClock().now() + options.wait;
  for (;;) {
    const Time rest = std::max(end - MonotonicClock().now(), Time::zero());
    if (commander.wait_in_force(number, std::min({rest, slice, kSignals}))) return true;
    if (rest == Time::zero() || stop_requested()) break;
    if (options.dead_man) (void)commander.renew();
  }
  say(fmt::format("'{}': request {} of '{}' is not in force after {:g} s; it remains", options.law,
                  number, options.commander, to_seconds(options.wait)));
  return false;
}

/// Requests a lower rate. Such a request is never refused, because the machine would run on: what
/// it does to the followers is looked at afterwards. A gentle one has the longest ramp first, and
/// the ramp that suffices as soon as that is known. Returns the number of the last request.
std::uint64_t lower(RateOptions options, RateCommander& commander,
                    const std::optional<Present>& present) {
  const Time shortest = std::exchange(options.ramp, options.gentle.value_or(options.ramp));
  std::uint64_t number = request(options, commander);
  try {
    if (present && options.gentle) {
      options.ramp = shortest;
      options.ramp = gentle_ramp(options, *present);
      if (options.ramp < *options.gentle) number = request(options, commander);
    }
    if (present) (void)report_effect(options, *present, true);
  } catch (const StreamError& error) {
    say(fmt::format("requested; its effect is not known: {}", error.what()));
  }
  return number;
}

int command(RateOptions options) {
  const bool holds = !options.release && *options.rate == 0;
  std::optional<Present> present;
  try {
    present = present_law(options);
    if (!present) say(fmt::format("'{}': waiting for a solver", options.law));
  } catch (const StreamError& error) {
    if (!holds) throw;
    say(error.what());
  }
  if (present && !options.release && *options.rate > present->law->max_rate()) {
    throw BadRequest(fmt::format("R is above the largest rate of '{}', {:g}: {:g}", options.law,
                                 present->law->max_rate(), *options.rate));
  }
  const bool lowers = holds || (!options.release && present && *options.rate <= present->from.rate);
  if (!lowers && present && options.gentle) options.ramp = gentle_ramp(options, *present);
  if (!lowers && present && !report_effect(options, *present, false)) return kFellShort;
  RateCommander commander(options.law, options.commander, {}, options.trust);
  const std::uint64_t number =
      lowers ? lower(options, commander, present) : request(options, commander);
  const bool is_in_force = wait_in_force(options, commander, number);
  if (options.dead_man && !stop_requested()) {
    const int code = keep_alive(options, commander);
    if (code != kOk) return code;
  }
  return is_in_force ? kOk : kNoStreamOrTimeOut;
}

void add_ramps(Command& verb, RateOptions& options) {
  add_seconds(verb, "--ramp", options.ramp, "Length of the ramp in s, 0.001 to 3600 (default 0.5)",
              kRamps);
  add_seconds(verb, "--gentle", options.gentle,
              "Lengthen the ramp to at most this time in s if the limits of a stream need it, from "
              "the ramp to 3600",
              kRamps);
}

void add_dead_man(Command& verb, RateOptions& options) {
  add_seconds(verb, "--dead-man", options.dead_man,
              "Run until SIGINT or SIGTERM and renew the request: the law holds if this process "
              "does not for this time in s, 0.001 to 3600",
              kRamps);
  add_seconds(verb, "--dead-man-ramp", options.dead_man_ramp,
              "Length of the ramp of that hold in s, 0.001 to 3600 (default 0.5)", kRamps);
}

void add_rate(Command& verb, Action& action) {
  auto options = std::make_shared<RateOptions>();
  verb.option("LAW", options->law, "Time law").required();
  verb.option(
          "R",
          [options](const std::string& text) {
            options->rate = number_within("R", text, {0, ipc::kLargestRate});
          },
          "Rate to request, stream time per host time, 0 (hold) to 100; without it, shows the law "
          "and its commanders")
      .type("R");
  add_ramps(verb, *options);
  verb.option("--as", options->commander, "Name of the commander (default operator)")
      .type("COMMANDER");
  verb.flag("--release", options->release, "Withdraw the commander's request");
  add_dead_man(verb, *options);
  add_seconds(verb, "--wait", options->wait,
              "Wait until the law's solver has put the request in force, for this time in s, 0 to "
              "3600 (default 1); 0 sends it only",
              {Time::zero(), ipc::kLongestRamp});
  verb.flag("--force", options->force, "Request it even if a stream would exceed its limits");
  verb.flag("--json", options->json, "Print JSON");
  add_trust(verb, options->trust);
  verb.callback([&action, options] {
    if (options->rate && options->release) throw UsageError("--release", "excludes a rate");
    if (options->gentle && *options->gentle < options->ramp) {
      throw UsageError("--gentle", "is shorter than the ramp");
    }
    action = [options] {
      ipc::require_stream_name(options->law);
      ipc::require_stream_name(options->commander);
      require_law(*options);
      if (!options->rate && !options->release) return show(*options);
      catch_stop_signals();
      return command(*options);
    };
  });
}

const Verb rate_verb("rate", 95, "Show or change the rate of a time law", add_rate);

}  // namespace
}  // namespace splinecast::apps
