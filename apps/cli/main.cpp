#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "apps/cli/command.hpp"
#include "apps/cli/guarded.hpp"
#include "apps/cli/nearest.hpp"
#include "apps/cli/verb.hpp"
#include "apps/cli/version.hpp"
#include "apps/process/exit_codes.hpp"

namespace splinecast::apps {
namespace {

/// Throws CLI::ValidationError unless there is such a verb, with the nearest one.
void require_verb(const CLI::App& program, const std::string& verb) {
  std::vector<std::string> verbs;
  for (const CLI::App* known : program.get_subcommands({})) verbs.push_back(known->get_name());
  if (std::ranges::find(verbs, verb) != verbs.end()) return;
  const auto meant = nearest(verb, verbs);
  throw CLI::ValidationError("there is no verb '" + verb + "'" +
                             (meant ? "; the nearest one is '" + *meant + "'" : ""));
}

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
    if (!verb.empty() && verb.front() != '-') require_verb(program, verb);
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool is_help = program.exit(error) == 0;
    if (!is_help) return kBadUsageOrInput;
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
