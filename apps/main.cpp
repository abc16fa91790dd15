#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>

#include "support/exit_codes.hpp"
#include "support/guarded.hpp"
#include "support/options.hpp"
#include "version.hpp"

namespace splinecast::apps {
namespace {

int run_program(int argc, char** argv) {
  CLI::App program("Online streaming cubic splines over shared memory", "splinecast");
  program.set_version_flag("--version", std::string("splinecast ") + kVersion);
  program.require_subcommand(1);
  Action action;
  add_demo(program, action);
  add_solve(program, action);
  add_replay(program, action);
  add_sample(program, action);
  add_fit(program, action);
  add_methods(program, action);
  add_latency(program, action);
  add_ls(program, action);
  add_info(program, action);
  add_rm(program, action);
  try {
    // CLI11 would only say that a subcommand is missing.
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
  }
  return run_guarded(action);
}

}  // namespace
}  // namespace splinecast::apps

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a write error like any other
  try {
    return splinecast::apps::run_program(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "splinecast: %s\n", error.what());
    return splinecast::apps::kFailed;
  }
}
