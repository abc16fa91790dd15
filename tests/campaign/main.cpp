#include <CLI/CLI.hpp>
#include <csignal>
#include <fstream>

#include "apps/cli/guarded.hpp"
#include "apps/output/stream.hpp"
#include "apps/process/exit_codes.hpp"
#include "apps/process/messages.hpp"
#include "apps/process/signals.hpp"
#include "tests/campaign/campaigns.hpp"

namespace splinecast::campaign {
namespace {

std::string joined(int argc, char** argv) {
  std::string text = "splinecast_campaign";
  for (int i = 1; i < argc; ++i) text += std::string(" ") + argv[i];
  return text;
}

/// Writes a result to a file, or to standard output if `path` is empty. Returns exit code 3 if a
/// promise was broken.
int report(const Result& result, const std::string& path) {
  const std::string text = result.json.dump(2) + "\n";
  if (path.empty()) {
    apps::print_report(text);
  } else {
    apps::Output output(path);
    output.write(text);
    output.close();
  }
  return result.is_sound ? apps::kOk : apps::kFellShort;
}

/// The command line.
struct Asked {
  CampaignOptions options{};
  std::string path{};  ///< file for the result; empty: standard output
  bool every_store = false;
  bool has_encoders = false;
  bool is_recorded = false;
  bool has_processes = false;
  bool lists = false;
  bool is_long = false;
};

using Run = Result (*)(const CampaignOptions&);

void add_kill(CLI::App& program, Asked& asked) {
  auto* verb = program.add_subcommand("kill", "Send SIGKILL to every process of a stream");
  verb->add_option("--kills", asked.options.kills, "Number of kills at random instants")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  verb->add_option("--seed", asked.options.seed, "Seed of the random instants")
      ->capture_default_str();
  verb->add_flag("--every-store", asked.every_store,
                 "Kill before each store to shared memory instead; needs a build with hooks");
}

void add_stress(CLI::App& program, Asked& asked) {
  auto* verb = program.add_subcommand("stress", "1 to 16 readers against the fastest writers");
  verb->add_option("--seconds", asked.options.seconds, "Duration for each number of readers")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
}

/// Adds the options of a campaign with one run per seed.
void add_runs(CLI::App* verb, Asked& asked, const char* seconds = "Duration, in CPU time") {
  verb->add_option("--seconds", asked.options.seconds, seconds)
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  verb->add_option("--seed", asked.options.seed, "Seed of the first run; each next run adds 1")
      ->capture_default_str();
  verb->add_option("--runs", asked.options.runs, "Number of runs instead of a duration");
}

void add_streams(CLI::App& program, Asked& asked) {
  add_runs(program.add_subcommand("streams", "Simulated live streams, one per seed"), asked);
}

void add_motions(CLI::App& program, Asked& asked) {
  auto* verb = program.add_subcommand("motions", "A motion with faults of its producer and solver");
  verb->add_option("--seed", asked.options.seed, "Seed of the motion")->capture_default_str();
  verb->add_flag("--encoders", asked.has_encoders, "Measure the stops after each tail instead");
  verb->add_option("--runs", asked.options.runs,
                   "Number of instants at which encoders end, per row; 0: 200");
  verb->add_flag("--recordings", asked.is_recorded,
                 "Play recordings with gaps instead; does nothing without recordings");
  verb->add_flag("--processes", asked.has_processes, "Run real processes in real time instead");
  verb->add_flag("--list", asked.lists, "Print the names of the plots and the faults, and exit");
  verb->add_option("--trace", asked.options.trace,
                   "Folder for CSV files of what readers see around each fault");
}

void add_returns(CLI::App& program, Asked& asked) {
  add_runs(program.add_subcommand("returns", "Returns to the waypoints after faults, one per seed"),
           asked);
}

void add_ends(CLI::App& program, Asked& asked) {
  add_runs(program.add_subcommand("ends", "Simulated lives that end in every way"), asked,
           "CPU time of each of the two threads");
}

void add_starts(CLI::App& program, Asked& asked) {
  add_runs(program.add_subcommand("starts", "Random beginnings of streams in simulated time"),
           asked);
}

void add_plans(CLI::App& program, Asked& asked) {
  add_runs(program.add_subcommand("plans", "Random operations on plans of curves"), asked);
}

void add_follow(CLI::App& program, Asked& asked) {
  auto* verb = program.add_subcommand("follow", "Sources that a curve within limits cannot meet");
  verb->add_option("--seed", asked.options.seed, "Seed of the first run")->capture_default_str();
  verb->add_option("--runs", asked.options.runs, "Number of runs of each source; 0: 20");
}

/// Adds the option of campaigns that can play their motions with Beyond::enter.
void add_enter(CLI::App* verb, Asked& asked) {
  verb->add_flag_callback(
      "--enter", [&asked] { asked.options.beyond = Beyond::enter; },
      "Solve streams with limits with --beyond enter");
}

void add_requests(CLI::App& program, Asked& asked) {
  auto* verb = program.add_subcommand("requests", "Requests of a rate by many commanders");
  verb->add_option("--seconds", asked.options.seconds, "Duration")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  verb->add_option("--seed", asked.options.seed, "Seed of the disturbances")->capture_default_str();
  verb->add_option("--runs", asked.options.runs,
                   "Simulate this number of requests in one process instead");
  verb->add_flag(
      "--every-store", asked.every_store,
      "Kill a stopper and its solver before each store instead; needs a build with hooks");
}

void add_record(CLI::App& program, Asked& asked) {
  auto* verb = program.add_subcommand("record", "The recorder, its files and its disk");
  add_runs(verb, asked, "Duration");
  auto* is_long = verb->add_flag("--long", asked.is_long, "Measure the memory of a recorder");
  verb->add_option("--items", asked.options.items, "With --long: number of items")
      ->capture_default_str()
      ->needs(is_long);
  verb->add_option("--names", asked.options.names, "With --long: number of streams")
      ->capture_default_str()
      ->check(CLI::PositiveNumber)
      ->needs(is_long);
}

/// The campaign of the given verb and flags.
Run run_of(const CLI::App& program, const Asked& asked) {
  if (asked.has_encoders) return run_stops;
  if (asked.is_recorded) return run_recordings;
  if (asked.has_processes) return run_live_motions;
  if (program.got_subcommand("motions")) return run_motions;
  if (program.got_subcommand("returns")) return run_returns;
  if (program.got_subcommand("ends")) return run_ends;
  if (program.got_subcommand("starts")) return run_starts;
  if (program.got_subcommand("plans")) return run_plans;
  if (program.got_subcommand("follow")) return run_follow;
  if (program.got_subcommand("streams")) return run_streams;
  if (program.got_subcommand("stress")) return run_stress;
  if (asked.is_long) return run_long_recording;
  if (program.got_subcommand("record")) return run_recorders;
  if (program.got_subcommand("requests")) {
    if (asked.every_store) return run_every_store_of_stops;
    return asked.options.runs > 0 ? run_simulated_requests : run_requests;
  }
  return asked.every_store ? run_every_store : run_random_kills;
}

int run_program(int argc, char** argv) {
  CLI::App program("Creates streams, attacks them and counts violations", "splinecast_campaign");
  program.require_subcommand(1);
  Asked asked{.options = {.command = joined(argc, argv)}};
  for (const auto& add : {add_kill, add_stress, add_streams, add_ends, add_starts, add_plans,
                          add_motions, add_returns, add_follow, add_requests, add_record}) {
    add(program, asked);
  }
  for (const char* name : {"motions", "returns"}) add_enter(program.get_subcommand(name), asked);
  for (CLI::App* verb : program.get_subcommands({})) {
    verb->add_option("--json", asked.path, "File for the result; default: standard output");
    verb->add_option("--command", asked.options.command,
                     "Command that the result names to repeat the campaign");
  }
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? apps::kOk : apps::kBadUsageOrInput;
  }
  return apps::run_guarded([&] {
    apps::catch_stop_signals();
    if (asked.lists) {
      apps::print_report(list_motions());
      return apps::kOk;
    }
    if (asked.is_recorded && !has_recordings()) {
      apps::say("there are no recordings on this machine");
      return apps::kOk;
    }
    return report(run_of(program, asked)(asked.options), asked.path);
  });
}

}  // namespace
}  // namespace splinecast::campaign

int main(int argc, char** argv) {
  try {
    return splinecast::campaign::run_program(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "splinecast_campaign: %s\n", error.what());
    return splinecast::apps::kFailed;
  }
}
