#include "replay.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "support/exit_codes.hpp"
#include "support/options.hpp"
#include "support/output.hpp"
#include "support/signals.hpp"

namespace splinecast::apps {
namespace {

/// ` (3 not increasing, 1 not finite)`; nothing for none.
std::string in_words(const std::array<ipc::Word, ipc::kRefusals>& refused) {
  std::string text;
  for (std::size_t i = 1; i < refused.size(); ++i) {
    if (refused[i] == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? " (" : ", ", refused[i],
                        ipc::to_string(static_cast<ipc::Refusal>(i)));
  }
  return text.empty() ? text : text + ")";
}

nlohmann::ordered_json to_json(const std::array<ipc::Word, ipc::kRefusals>& refused) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (std::size_t i = 1; i < refused.size(); ++i) {
    json[std::string(ipc::to_string(static_cast<ipc::Refusal>(i)))] = refused[i];
  }
  return json;
}

int run_replay(ReplayOptions options) {
  catch_stop_signals();
  ipc::Word unreadable = 0;
  if (options.skip_bad) {
    options.table.on_bad_row = [&unreadable](const InputError& error) {
      say(error.what());
      ++unreadable;
    };
  }
  WaypointTable table = read_waypoints(options.file, options.table);
  const ipc::Word unfit = prepare_replay(table, options);
  ReplayReport report = replay_table(table, options);
  report.skipped = unreadable + unfit;
  if (options.json) {
    const nlohmann::ordered_json json{{"stream", options.stream},
                                      {"sent", report.sent},
                                      {"interpolated", report.interpolated},
                                      {"refused", report.refused},
                                      {"refused_by_reason", to_json(report.refused_by_reason)},
                                      {"skipped", report.skipped},
                                      {"interrupted", report.interrupted}};
    print_report(json.dump(2) + "\n");
  } else {
    say(fmt::format("'{}': {} waypoints sent, {} interpolated, {} refused{}, {} rows skipped{}",
                    options.stream, report.sent, report.interpolated, report.refused,
                    in_words(report.refused_by_reason), report.skipped,
                    report.interrupted ? "; interrupted" : ""));
  }
  return report.refused > 0 && !options.skip_bad ? kFailed : kOk;
}

void add_playback_options(CLI::App& verb, ReplayOptions& options) {
  verb.add_option_function<std::string>(
          "--rate",
          [&options](const std::string& text) {
            if (text == "max") {
              options.rate.reset();
            } else {
              options.rate = positive_number("--rate", text);
            }
          },
          "Play R times as fast as recorded (default 1), or as fast as it goes: max")
      ->type_name("R|max");
  add_count(verb, "--loop", options.loops, "Play the recording N times (default 1)");
  add_seconds(verb, "--from", options.from, "Begin this long after the first waypoint");
  add_seconds(verb, "--duration", options.duration, "Play only so much of the recording");
  verb.add_option_function<std::string>(
          "--clock",
          [&options](const std::string& text) {
            if (text != "live" && text != "recorded") {
              throw CLI::ValidationError("--clock",
                                         fmt::format("'{}' is neither live nor recorded", text));
            }
            options.clock =
                text == "live" ? ipc::StreamClock::monotonic : ipc::StreamClock::recorded;
          },
          "live (default): now on this host's clock; recorded: the file's own stamps")
      ->type_name("CLOCK");
  add_milliseconds(verb, "--lead", options.lead,
                   "Append each waypoint of a live stream this long before its time (default 200)");
  add_condition(verb, "--start", options.start,
                "Condition at the first waypoint (default halt; if recorded, the method's own)");
  add_condition(
      verb, "--end", options.end,
      "Condition at the last waypoint (default halt; if recorded, the method's own, which "
      "for c2 is halt)");
}

void add_interval(CLI::App& verb, const std::string& name, core::Time& value,
                  const std::string& help) {
  verb.add_option_function<std::string>(
          name,
          [&value, name](const std::string& text) {
            value = positive_time(name, text, TimeUnit::seconds);
          },
          help)
      ->type_name("SECONDS");
}

}  // namespace

void add_replay(CLI::App& program, Action& action) {
  auto options = std::make_shared<ReplayOptions>();
  auto* verb = program.add_subcommand("replay", "Send a recorded stream to a solver");
  verb->add_option("FILE", options->file, "Waypoint file, CSV or TUM text; - for standard input")
      ->required();
  verb->add_option("--stream", options->stream, "Stream to produce")->required();
  add_playback_options(*verb, *options);
  verb->add_option_function<std::string>(
          "--on-error",
          [options](const std::string& text) {
            if (text != "skip" && text != "stop") {
              throw CLI::ValidationError("--on-error",
                                         fmt::format("'{}' is neither skip nor stop", text));
            }
            options->skip_bad = text == "skip";
          },
          "What to do about a row that cannot be sent: stop (default), before anything is sent, or "
          "skip it")
      ->type_name("skip|stop");
  add_count(*verb, "--capacity", options->capacity,
            "Waypoints that the ring holds (default 1024; rounded up to a power of two)");
  add_seconds(*verb, "--wait", options->wait, "Wait this long for a solver (default 10)");
  add_interval(*verb, "--min-interval", options->limits.min_interval,
               "Least time between waypoints (default 1e-6)");
  add_interval(*verb, "--max-interval", options->limits.max_interval,
               "Most time between waypoints (default 3600)");
  verb->add_flag("--embedded", options->embedded, "Solve in this process");
  add_solver_curve(*verb, options->solver);
  verb->add_flag("--json", options->json, "Report as JSON on standard output");
  add_table_options(*verb, options->table);
  add_access(*verb, options->access);
  add_trust(*verb, options->trust);
  verb->callback([&action, options] {
    const ipc::SolverOptions& curve = options->solver;
    const bool shapes = curve.method != nullptr || curve.lambda || curve.time_scale ||
                        curve.settle || curve.tail || curve.force_lag;
    if (shapes && !options->embedded) {
      throw CLI::ValidationError("--method, --lambda, --time-scale, --settle, --tail, --force-lag",
                                 "go with --embedded; else tell 'solve'");
    }
    options->solver.access = options->access;
    options->solver.trust = options->trust;
    action = [options] { return run_replay(*options); };
  });
}

}  // namespace splinecast::apps
