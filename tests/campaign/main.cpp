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

/// Writes a result where it was asked for. Exit code 3 if a promise was broken.
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

/// What the command line asks for.
struct Asked {
  CampaignOptions options{};
  std::string path{};  ///< of the result; empty: standard output
  bool every_store = false;
  bool has_encoders = false;
  bool is_recorded = false;
  bool has_processes = false;
  bool lists = false;
};

using Run = Result (*)(const CampaignOptions&);

void add_kill(CLI::App& program, Asked& asked) {
  auto* verb = program.add_subcommand("kill", "SIGKILL to every process of a stream");
  verb->add_option("--kills", asked.options.kills, "How many, at random instants")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  verb->add_option("--seed", asked.options.seed, "Of the random instants")->capture_default_str();
  verb->add_flag("--every-store", asked.every_store,
                 "Before each store to shared memory instead; needs a build with hooks");
}

void add_stress(CLI::App& program, Asked& asked) {
  auto* verb = program.add_subcommand("stress", "1 to 16 readers against the fastest writers");
  verb->add_option("--seconds", asked.options.seconds, "For each number of readers")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
}

void add_streams(CLI::App& program, Asked& asked) {
  auto* verb = program.add_subcommand("streams", "Simulated live streams, one per seed");
  verb->add_option("--seconds", asked.options.seconds, "How long")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  verb->add_option("--seed", asked.options.seed, "Of the first stream; the next has the next one")
      ->capture_default_str();
  verb->add_option("--runs", asked.options.runs, "Number of streams to simulate instead");
}

void add_motions(CLI::App& program, Asked& asked) {
  auto* verb = program.add_subcommand("motions", "A motion whose producer meets mishaps");
  verb->add_option("--seed", asked.options.seed, "Of the motion")->capture_default_str();
  verb->add_flag("--encoders", asked.has_encoders, "Measure stops behind each tail instead");
  verb->add_option("--runs", asked.options.runs, "Instants at which encoders end, per row; 0: 200");
  verb->add_flag("--recordings", asked.is_recorded,
                 "Play recordings with gaps instead; does nothing where there are none");
  verb->add_flag("--processes", asked.has_processes, "In real time, with processes, instead");
  verb->add_flag("--list", asked.lists, "Print the names of the plots and the mishaps, and end");
  verb->add_option("--trace", asked.options.trace,
                   "Folder for what readers see around each mishap, as CSV");
}

void add_returns(CLI::App& program, Asked& asked) {
  auto* verb = program.add_subcommand("returns", "Ways back onto the waypoints, one per seed");
  verb->add_option("--seconds", asked.options.seconds, "How long")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  verb->add_option("--seed", asked.options.seed, "Of the first run")->capture_default_str();
  verb->add_option("--runs", asked.options.runs, "Number of runs instead");
}

/// The campaign of the verb that was given.
Run run_of(const CLI::App& program, const Asked& asked) {
  if (asked.has_encoders) return run_stops;
  if (asked.is_recorded) return run_recordings;
  if (asked.has_processes) return run_live_motions;
  if (program.got_subcommand("motions")) return run_motions;
  if (program.got_subcommand("returns")) return run_returns;
  if (program.got_subcommand("streams")) return run_streams;
  if (program.got_subcommand("stress")) return run_stress;
  return asked.every_store ? run_every_store : run_random_kills;
}

int run_program(int argc, char** argv) {
  CLI::App program("Attacks streams of its own and counts what breaks", "splinecast_campaign");
  program.require_subcommand(1);
  Asked asked{.options = {.command = joined(argc, argv)}};
  for (const auto& add : {add_kill, add_stress, add_streams, add_motions, add_returns}) {
    add(program, asked);
  }
  for (CLI::App* verb : program.get_subcommands({})) {
    verb->add_option("--json", asked.path, "File for the result; else standard output");
    verb->add_option("--command", asked.options.command, "What the result says that runs it again");
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
