#include "apps/cli/options.hpp"

namespace splinecast::apps {

void add_verbs(CLI::App& program, Action& action) {
  add_demo(program, action);
  add_solve(program, action);
  add_replay(program, action);
  add_sample(program, action);
  add_fit(program, action);
  add_check(program, action);
  add_methods(program, action);
  add_advise(program, action);
  add_latency(program, action);
  add_ls(program, action);
  add_info(program, action);
  add_rm(program, action);
  add_doctor(program, action);
  add_soak(program, action);
}

}  // namespace splinecast::apps
