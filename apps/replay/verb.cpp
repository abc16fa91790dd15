#include "apps/replay/player.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/cli/option_rows.hpp"
#include "apps/cli/options.hpp"
#include "apps/cli/verb.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "apps/record/executed/exact_messages.hpp"
#include "apps/record/verification/verify_file.hpp"
#include "apps/streams/log.hpp"
#include "apps/streams/report.hpp"

namespace splinecast::apps {
namespace {

using nlohmann::ordered_json;

/// The number of rows that were not sent, by reason.
ordered_json skipped_by_reason(const RefusedRows& refused) {
  const auto count = [&](std::string_view reason) {
    return refused.count(RefusedBy::file, reason) + refused.count(RefusedBy::producer, reason);
  };
  ordered_json json{{kUnreadable, count(kUnreadable)}};
  for (std::uint8_t i = 1; i < kAppendStatuses; ++i) {
    const auto status = static_cast<AppendStatus>(i);
    if (status == AppendStatus::full) continue;  // retried until there is room
    json[std::string(to_string(status))] = count(to_string(status));
  }
  const std::string_view no_rotation = to_string(Refusal::zero_quaternion);
  json[std::string(no_rotation)] = count(no_rotation);
  return json;
}

/// The number of sent waypoints that were refused, by reason.
ordered_json refused_by_reason(const ReplayReport& report) {
  ordered_json json = ordered_json::object();
  for (std::size_t i = 1; i < report.refused_by_reason.size(); ++i) {
    const auto reason = static_cast<Refusal>(i);
    json[std::string(to_string(reason))] = report.refused_by_reason[i];
  }
  return json;
}

/// ` (3 duplicate, 1 not finite)`; empty if all counts are 0.
std::string in_words(const ordered_json& by_reason) {
  std::string text;
  for (const auto& [reason, count] : by_reason.items()) {
    if (count == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? " (" : ", ", count.get<ipc::Word>(), reason);
  }
  return text.empty() ? text : text + ")";
}

/// Differences of a replay from its plan, as text.
std::string in_words(const ReplayReport& report, const ReplayOptions& options,
                     const RefusedRows& refused, std::string_view row_name) {
  std::string text;
  if (options.late != LatePolicy::refuse && report.late != LateRows{}) {
    text.append("; ").append(apps::in_words(report.late));
  }
  const ipc::Word named = refused.count(RefusedBy::solver);
  if (report.refused > named) {
    text += fmt::format("; {} refusals came too fast to be named", report.refused - named);
  }
  if (report.gaps.count > 0)
    text += "; " + apps::in_words(report.gaps, options.gap.policy, row_name);
  text += end_in_words(report.end);
  if (report.interrupted) text += "; interrupted";
  if (report.unsent > 0) text += fmt::format("; {} not sent", report.unsent);
  if (report.verification) text.append("; ").append(apps::in_words(*report.verification));
  return text;
}

/// Whether the file's own streams are to be solved again. A log of others is sent as any file is.
bool verifies_recording(const ReplayOptions& options) {
  if (!options.verify) return false;
  return options.stream.empty() ? record::is_mcap_file(options.file)
                                : record::is_recording(options.file);
}

/// Solves the streams of a recording again. Sends nothing.
int verify_recording(const ReplayOptions& options) {
  const auto found = record::verify_file(options.file, options.stream);
  if (options.json) {
    print_report(record::to_json(found).dump(2) + "\n");
  } else {
    for (const std::string& line : record::to_lines(found)) say(line);
  }
  return record::exit_code(found);
}

int run_replay(const ReplayOptions& options) {
  if (verifies_recording(options)) return verify_recording(options);
  RefusedRows refused;
  Recording recording = open_recording(options, refused);
  require_playable(recording, options);
  catch_stop_signals();  // before this there is no stream to end
  ReplayReport report = replay_recording(recording, options, refused);
  report.late += recording.survey().late;
  const ipc::Word skipped = refused.count(RefusedBy::file) + refused.count(RefusedBy::producer);
  if (options.json) {
    ordered_json json{{"stream", options.stream},
                      {"sent", report.sent},
                      {"interpolated", report.interpolated},
                      {"passed_over", report.passed_over},
                      {"refused", report.refused},
                      {"refused_by_reason", refused_by_reason(report)},
                      {"skipped", skipped},
                      {"skipped_by_reason", skipped_by_reason(refused)},
                      {"late", to_json(report.late, options.late)},
                      {"gaps", to_json(report.gaps, options.gap.policy)},
                      {"unsent", report.unsent},
                      {"end", end_json(report.end)},
                      {"interrupted", report.interrupted},
                      {"rows", refused.to_json(recording.row_name())},
                      {"rows_not_listed", refused.unlisted()}};
    if (report.verification) json["verification"] = to_json(*report.verification);
    print_report(json.dump(2) + "\n");
  } else {
    say(fmt::format("'{}': {} waypoints sent, {} interpolated{}, {} refused{}, {} rows skipped{}{}",
                    options.stream, report.sent, report.interpolated,
                    passed_over_in_words(report.passed_over), report.refused,
                    in_words(refused_by_reason(report)), skipped,
                    in_words(skipped_by_reason(refused)),
                    in_words(report, options, refused, recording.row_name())));
  }
  return exit_code(report);
}

void add_rate(Command& verb, ReplayOptions& options) {
  verb.option(
          "--rate",
          [&options](const std::string& text) {
            if (text == "max") {
              options.rate.reset();
            } else {
              options.rate = number_within("--rate", text);
            }
          },
          "Playback rate relative to the recording, 1e-6 to 1e9, or max: as fast as possible "
          "(default 1)")
      .type("R|max");
}

void add_clock(Command& verb, ReplayOptions& options) {
  add_choice(
      verb, "--clock", "live", "recorded",
      [&options](bool live) {
        options.ring.clock = live ? StreamClock::monotonic : StreamClock::recorded;
      },
      "Clock of the stream: live (default), this host's clock, from now on; recorded, the file's "
      "time stamps");
}

void add_law(Command& verb, ReplayOptions& options) {
  verb.option("--law", options.ring.law,
              "Time law that the stream follows: the times of its waypoints are the law's stream "
              "time")
      .type("LAW");
}

void add_start_from(Command& verb, ReplayOptions& options) {
  verb.option(
          "--start-from",
          [&options](const std::string& text) {
            if (text == "old") {
              options.start_from = FromOldEnd{};
            } else if (text == "first") {
              options.start_from = FromFirst{};
            } else if (auto values = parse_values(text)) {
              options.start_from = std::move(*values);
            } else {
              throw UsageError("--start-from",
                               fmt::format("'{}' is not old, first, or a list of numbers", text));
            }
          },
          "Where the machine is when a live stream is created again: old, where the earlier one "
          "came to rest: an entry leads from there, and the lead grows by it; first, moved to the "
          "first waypoint; or its measured position, one value per dimension (default: the first "
          "waypoint must be where the earlier stream came to rest)")
      .type("old|first|VALUES");
}

void add_playback_options(Command& verb, ReplayOptions& options) {
  add_rate(verb, options);
  add_count(verb, "--loop", options.loops,
            "Number of times to play the recording, 1 to 1e9 (default 1)", {1, 1'000'000'000});
  add_seconds(verb, "--from", options.from,
              "Time in s after the first waypoint at which to begin, from 0 (default 0)");
  add_seconds(verb, "--duration", options.duration,
              "Length in s of the part of the recording to play, from 0 (default: to the end)");
  add_clock(verb, options);
  add_law(verb, options);
  verb.option(
          "--lead",
          [&options](const std::string& text) {
            options.lead = time_within("--lead", text, TimeUnit::milliseconds, kAnyTime);
          },
          "Time in ms from the append of a waypoint of a live stream to its time, from 0 (default: "
          "as 'advise' recommends, at least 200)")
      .type("MS");
  add_condition(verb, "--start", options.start,
                "Boundary condition at the first waypoint (default: halt; with --clock recorded "
                "the method's own)");
  add_start_from(verb, options);
  add_end(
      verb, options.end,
      "Boundary condition at the last waypoint; of a live stream rest, clamped or halt: at rest "
      "there, within limits (default: rest; with --clock recorded the method's own, which for "
      "c2 is halt)");
}

/// Throws InputError if all loops together take longer than a time can represent.
void require_loops(const Recording& recording, std::size_t loops) {
  if (loops == 1) return;
  const Survey& survey = recording.survey();
  const Time once = survey.last - survey.first + survey.median;
  const double seconds = static_cast<double>(loops) * to_seconds(once);
  if (seconds <= to_seconds(kLongestTime)) return;
  throw InputError(fmt::format("{}: --loop {} takes {} s; the maximum is {} s", recording.name(),
                               loops, seconds, to_seconds(kLongestTime)));
}

}  // namespace

Preparation preparation_of(const ReplayOptions& options) {
  return {.from = options.from,
          .duration = options.duration,
          .rate = options.rate.value_or(1.0),
          .intervals = {.least = options.ring.limits.min_interval,
                        .most = options.ring.limits.max_interval},
          .late = options.late,
          .gap = options.gap};
}

Recording open_recording(const ReplayOptions& options, RefusedRows& refused) {
  std::unique_ptr<RowReader> rows = open_rows(options.file, options.table);
  std::vector<Dimension> kinds = kinds_of(*rows, options.table.kinds);
  return Recording(std::move(rows), std::move(kinds), preparation_of(options),
                   options.skip_bad ? &refused : nullptr);
}

void require_playable(const Recording& recording, const ReplayOptions& options) {
  require_loops(recording, options.loops);
  const std::size_t dimensions = recording.columns().dimensions();
  const Condition* start = options.start ? &*options.start : nullptr;
  const Condition* end = condition_of(options.end);
  if (end != nullptr) DimensionKinds(recording.kinds()).require_end(*end);
  for (const Condition* condition : {start, end}) {
    if (condition == nullptr) continue;
    require_values(*condition, dimensions);
    if (!is_online(condition->kind)) {
      throw InputError(
          fmt::format("condition '{}' needs all waypoints at once: a stream cannot "
                      "meet it",
                      to_string(*condition)));
    }
  }
}

int exit_code(const ReplayReport& report) {
  if (report.verification && report.verification->first) return kFellShort;
  if (report.stopped) return *report.stopped == RefusedBy::solver ? kFailed : kBadUsageOrInput;
  return report.interrupted ? kInterrupted : kOk;
}

namespace {

void add_row_policies(Command& verb, ReplayOptions& options) {
  add_choice(
      verb, "--on-error", "skip", "stop", [&options](bool skip) { options.skip_bad = skip; },
      "On a refused row: stop the replay (default), or skip the row");
  verb.option(
          "--late",
          [&options](const std::string& text) {
            const auto policy = parse_late_policy(text);
            if (!policy) {
              throw UsageError("--late",
                               fmt::format("'{}' is not one of pass, shift, refuse", text));
            }
            options.late = *policy;
          },
          "On a row that is not after the row before: refuse (default) it; pass: leave it out; "
          "shift: move it and all later rows. On a row whose time has settled when it can be "
          "sent: shift moves them too, refuse and pass send it as it is")
      .type("pass|shift|refuse");
}

void add_ring_options(Command& verb, ReplayOptions& options) {
  add_row(verb, ipc::stream_option<&ipc::capacity_of>(), options.ring.capacity, "N");
  add_seconds(verb, "--wait", options.wait, "Time in s to wait for a solver, from 0 (default 10)");
  IngestLimits& allowed = options.ring.limits;
  add_row(verb, ipc::stream_option<&ipc::min_interval_of>(), allowed.min_interval, "SECONDS");
  add_row(verb, ipc::stream_option<&ipc::max_interval_of>(), allowed.max_interval, "SECONDS");
}

/// Throws UsageError for options that exclude one another.
void require_agreeing(const ReplayOptions& options) {
  const SolverOptions& curve = options.solver;
  bool shapes = curve.method != nullptr;
  ipc::for_each_option([&](const auto& row) { shapes = shapes || is_set(row, curve); });
  if (shapes && !options.embedded) {
    throw UsageError("--method, --lambda, --time-scale, --settle, --tail, --force-lag",
                     "go with --embedded only; without it they are options of 'solve'");
  }
  if (!options.ring.law.empty() && !is_live(options.ring.clock)) {
    throw UsageError("--law", "goes with --clock live only");
  }
  if (options.start_from && !is_live(options.ring.clock)) {
    throw UsageError("--start-from", "goes with --clock live only");
  }
  const Condition* end = condition_of(options.end);
  if (is_live(options.ring.clock) && end != nullptr && !is_at_rest(end->kind)) {
    throw UsageError("--end", "a live stream ends at rest: rest, clamped or halt");
  }
}

void add_replay(Command& verb, Action& action) {
  auto options = std::make_shared<ReplayOptions>();
  verb.option(
          "FILE", options->file,
          "Waypoint file, CSV or TUM text; - for standard input. With --verify also a recording "
          "of 'record': its streams are solved again, in memory only")
      .required();
  const auto stream =
      verb.option("--stream", options->stream,
                  "Stream to produce; of a recording, the only stream to verify (default: all)")
          .type("STREAM");
  add_playback_options(verb, *options);
  add_row_policies(verb, *options);
  add_gap(verb, options->gap);
  add_ring_options(verb, *options);
  verb.flag("--embedded", options->embedded, "Solve in this process");
  verb.flag("--verify", options->verify,
            "Solve the sent waypoints again, with the decisions that the stream records, and "
            "compare every segment bit by bit; exit code 3 if one differs. Of a recording: compare "
            "with its segments");
  add_solver_curve(verb, options->solver);
  verb.flag("--json", options->json, "Print JSON");
  add_table_options(verb, options->table);
  add_access(verb, options->ring.access);
  add_trust(verb, options->ring.trust);
  verb.callback([&action, options, stream] {
    if (!stream.is_given() && !verifies_recording(*options)) {
      throw UsageError("--stream", "is required");
    }
    if (!is_live(options->ring.clock)) take_former_rest(options->end);
    require_agreeing(*options);
    options->quiet = options->table.quiet;
    if (!options->ring.law.empty()) options->ring.clock = StreamClock::law;
    options->solver.access = options->ring.access;
    options->solver.trust = options->ring.trust;
    action = [options] { return run_replay(*options); };
  });
}

const Verb replay_verb("replay", 30, "Send a recorded stream to a solver", add_replay);

}  // namespace

}  // namespace splinecast::apps
