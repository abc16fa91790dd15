#include "ipc/sweep/news.hpp"

#include <exception>
#include <utility>

#include "ipc/roles/internals.hpp"

namespace splinecast::ipc {

void ReportedNews::report(Solver& solver, const NotifyNews& notify, Scratch& scratch) noexcept try {
  const std::string& stream = solver.stream();
  solver.take_first_refusals(scratch.refused);
  for (const ItemRefusal& refusal : scratch.refused) {
    notify(SweepNews::refused, stream, &solver, to_string(refusal));
  }
  if (const auto excess = solver.take_first_excess()) {
    notify(SweepNews::beyond_limits, stream, &solver, solver.in_words(*excess));
  }
  scratch.faults.clear();
  solver.take_commander_faults(scratch.faults);
  for (const std::string& fault : scratch.faults) {
    notify(SweepNews::commander, stream, &solver, fault);
  }
  if (!solver.attached()) return;
  const Summary& summary = Internals::summary(solver);
  const Following following = summary.following();
  if (std::exchange(following_, following) != following) {
    notify(SweepNews::following, stream, &solver, {});
  }
  if (summary.finished && !std::exchange(was_finished_, true)) {
    notify(SweepNews::finished, stream, &solver, {});
  }
} catch (const std::exception&) {
  return;  // a message that fails changes nothing for the stream
}

}  // namespace splinecast::ipc
