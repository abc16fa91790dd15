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

int run_program(int argc, char** argv) {
  CLI::App program("Attacks streams of its own and counts what breaks", "splinecast_campaign");
  program.require_subcommand(1);
  CampaignOptions options{.command = joined(argc, argv)};
  std::string path;
  bool every_store = false;
  auto* kill = program.add_subcommand("kill", "SIGKILL to every process of a stream");
  kill->add_option("--kills", options.kills, "How many, at random instants")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  kill->add_option("--seed", options.seed, "Of the random instants")->capture_default_str();
  kill->add_flag("--every-store", every_store,
                 "Before each store to shared memory instead; needs a build with hooks");
  auto* stress = program.add_subcommand("stress", "1 to 16 readers against the fastest writers");
  stress->add_option("--seconds", options.seconds, "For each number of readers")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  auto* streams = program.add_subcommand("streams", "Simulated live streams, one per seed");
  streams->add_option("--seconds", options.seconds, "How long")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  streams->add_option("--seed", options.seed, "Of the first stream; the next has the next one")
      ->capture_default_str();
  streams->add_option("--runs", options.runs, "Number of streams to simulate instead");
  auto* motions = program.add_subcommand("motions", "A motion whose producer meets mishaps");
  motions->add_option("--seed", options.seed, "Of the motion")->capture_default_str();
  bool has_encoders = false;
  motions->add_flag("--encoders", has_encoders, "Measure stops behind each tail instead");
  motions->add_option("--runs", options.runs, "Instants at which encoders end, per row; 0: 200");
  bool is_recorded = false;
  motions->add_flag("--recordings", is_recorded,
                    "Play recordings with gaps instead; does nothing where there are none");
  bool has_processes = false;
  motions->add_flag("--processes", has_processes, "In real time, with processes, instead");
  bool lists = false;
  motions->add_flag("--list", lists, "Print the names of the plots and the mishaps, and end");
  motions->add_option("--trace", options.trace,
                      "Folder for what readers see around each mishap, as CSV");
  auto* returns = program.add_subcommand("returns", "Ways back onto the waypoints, one per seed");
  returns->add_option("--seconds", options.seconds, "How long")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  returns->add_option("--seed", options.seed, "Of the first run")->capture_default_str();
  returns->add_option("--runs", options.runs, "Number of runs instead");
  for (CLI::App* verb : {kill, stress, streams, motions, returns}) {
    verb->add_option("--json", path, "File for the result; else standard output");
    verb->add_option("--command", options.command, "What the result says that runs it again");
  }
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? apps::kOk : apps::kBadUsageOrInput;
  }
  return apps::run_guarded([&] {
    apps::catch_stop_signals();
    if (lists) {
      apps::print_report(list_motions());
      return apps::kOk;
    }
    if (is_recorded && !has_recordings()) {
      apps::say("there are no recordings on this machine");
      return apps::kOk;
    }
    const Result result = has_encoders    ? run_stops(options)
                          : is_recorded   ? run_recordings(options)
                          : has_processes ? run_live_motions(options)
                          : *motions      ? run_motions(options)
                          : *returns      ? run_returns(options)
                          : *streams      ? run_streams(options)
                          : *stress       ? run_stress(options)
                          : every_store   ? run_every_store(options)
                                          : run_random_kills(options);
    return report(result, path);
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
