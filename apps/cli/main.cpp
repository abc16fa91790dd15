#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>

#include "apps/cli/command.hpp"
#include "apps/cli/guarded.hpp"
#include "apps/cli/verb.hpp"
#include "apps/cli/version.hpp"
#include "apps/process/exit_codes.hpp"

namespace splinecast::apps {
namespace {

int run_program(int argc, char** argv) {
  CLI::App program("Online streaming cubic splines over shared memory", "splinecast");
  program.set_version_flag("--version", std::string("splinecast ") + kVersion);
  program.require_subcommand(1);
  Action action;
  Command command(program);
  Verb::add_all(command, action);
  try {
    // CLI11 would only report a missing subcommand.
    const std::string verb = argc > 1 ? argv[1] : "";
    const auto verbs =
        program.get_subcommands([&](const CLI::App* known) { return known->get_name() == verb; });
    if (!verb.empty() && verb.front() != '-' && verbs.empty()) {
      throw CLI::ValidationError("there is no verb '" + verb + "'");
    }
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool asked_for_help = program.exit(error) == 0;
    if (!asked_for_help) return kBadUsageOrInput;
    return std::cout.flush() ? kOk : kFailed;
  } catch (const UsageError& error) {
    program.exit(CLI::ValidationError(error.what()));
    return kBadUsageOrInput;
  }
  return run_guarded(action);
}

}  // namespace
}  // namespace splinecast::apps

int main(int argc, char** argv) {
  // Turn a closed pipe, and a file larger than RLIMIT_FSIZE, into ordinary write errors.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return splinecast::apps::run_program(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "splinecast: %s\n", error.what());
    return splinecast::apps::kFailed;
  }
}
