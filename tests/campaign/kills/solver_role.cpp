#include <chrono>
#include <optional>

#include "apps/process/signals.hpp"
#include "splinecast/clock.hpp"
#include "splinecast/errors.hpp"
#include "splinecast/solver.hpp"
#include "splinecast/streams.hpp"
#include "tests/campaign/kills/roles.hpp"

namespace splinecast::campaign {
namespace {

constexpr Time kLongestWait = std::chrono::milliseconds(50);

Step publishing(ipc::ItemKind kind) {
  switch (kind) {
    case ipc::ItemKind::replace:
      return Step::publish_replacement;
    case ipc::ItemKind::finish:
      return Step::publish_finish;
    default:
      return Step::publish;
  }
}

bool attach(Solver& solver, Journal& journal, Step making) {
  WithinStep attaching(journal, making);
  if (!solver.attach()) return false;
  attaching.survived();
  return true;
}

bool step(Solver& solver, Journal& journal, const Clock& clock) {
  WithinStep stepping(journal, publishing(journal.last_sent));
  const StepResult result = solver.step(clock);
  if (result.consumed > 0) stepping.survived();
  return result.consumed > 0 || result.missed;
}

void sleep(Solver& solver, Journal& journal) {
  WithinStep sleeping(journal, Step::sleep);
  solver.wait(kLongestWait);
  if (solver.attached()) sleeping.survived();
}

}  // namespace

std::optional<Solver> await_solver(const std::string& stream, const SolverOptions& options) {
  const MonotonicClock clock;
  do {
    try {
      return Solver(stream, options);
    } catch (const StreamBusy&) {  // the attacking process counts a hang if it stays so
    }
  } while (apps::sleep_until(clock.now() + std::chrono::microseconds(200)));
  return std::nullopt;
}

void run_solver(const Plan& plan, Journal& journal) {
  const MonotonicClock clock;
  std::optional<Solver> solver = await_solver(plan.stream, plan.solver_options());
  Step making = Step::make_board;
  while (solver && !apps::stop_requested()) {
    const bool is_attached = solver->attached() || attach(*solver, journal, making);
    if (is_attached) making = Step::make_board_again;
    if (!is_attached || !step(*solver, journal, clock)) sleep(*solver, journal);
  }
}

void run_remover(const Plan& plan, Journal& journal) {
  WithinStep removing(journal, Step::remove);
  remove_stream(plan.stream);
  removing.survived();
}

}  // namespace splinecast::campaign
